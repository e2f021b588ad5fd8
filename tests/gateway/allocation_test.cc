// A whole tick of the arm's scene, as visumd does it in real time: mailbox, drives, part, collision, engine,
// the copy for the sessions. Allocations inside FCL and ODE are counted apart.
#include <gtest/gtest.h>

#include "server/gateway/mailbox.h"
#include "server/gateway/published.h"
#include "server/gateway/tick_side.h"
#include "server/world/exchange.h"
#include "tests/support/allocation_counter.h"

namespace visum::gateway {
namespace {

constexpr std::uint32_t kArm = 0;

struct Rig {
  cycle::Simulation simulation{
      scene::load_scene(std::filesystem::path(VISUM_SOURCE_DIR) / "models/scenes/amtec_arm.yaml")};
  const std::vector<double> middle = simulation.parts()[kArm].controller_inputs;
  Mailbox mailbox{middle.size()};
  TickSide tick_side{simulation, mailbox, true};
  world::Exchange<Published> exchange;

  // Moves the joints to and fro, every 10 ms, as a controller would.
  void command() {
    Input* input = mailbox.blank_input();
    input->kind = Input::Kind::kWrite;
    input->part = kArm;
    input->first_port = 0;
    input->values.assign(middle.begin(), middle.end());
    const double side = (simulation.tick_count() / 250) % 2 == 0 ? 0.1 : -0.1;
    for (std::size_t joint = 0; joint < 7; ++joint) input->values[joint] += side;
    mailbox.send(input);
  }

  void run(int ticks) {
    for (int i = 0; i < ticks; ++i) {
      if (i % 10 == 0) command();
      tick_side.empty_mailbox();
      tick_side.tick();
      fill(exchange.back(), simulation, tick_side.pace(), tick_side.part_table());
      exchange.publish();
      exchange.refresh();
    }
  }
};

TEST(Tick, AllocatesNothingOfOursOnceWarm) {
  Rig rig;
  rig.run(1500);
  const auto start = rig.simulation.state().joints;
  test_support::AllocationCounts counts;
  std::string ours;
  {
    const test_support::AllocationScope scope;
    rig.run(1000);
    counts = scope.counts();
    ours = scope.describe_ours();
  }
  EXPECT_EQ(counts.ours, 0u) << ours;
  RecordProperty("allocations_of_libraries_per_tick", static_cast<int>(counts.foreign / 1000));
  EXPECT_FALSE(rig.simulation.frozen()) << rig.simulation.fault();
  EXPECT_FALSE(rig.simulation.contacts().empty());
  EXPECT_NE(start.front().position, rig.simulation.state().joints.front().position);
}

}  // namespace
}  // namespace visum::gateway
