// Faults at the borders between ticks: which write is the first that passes again, and which faults are too
// large.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "server/cycle/apply_input.h"
#include "server/cycle/simulation.h"
#include "server/scene/scene.h"

namespace visum::cycle {
namespace {

scene::Scene two_link_with_tick(std::int64_t tick_ns) {
  auto scene = scene::load_scene(std::filesystem::path(VISUM_SOURCE_DIR) / "models/scenes/two_link.yaml");
  scene.world.tick_ns = tick_ns;
  return scene;
}

hwparts::ActiveFault fault_of_robot(const char* kind, const hwparts::NamedNumbers& numbers,
                                    std::int64_t until) {
  std::string why;
  const auto fault = hwparts::make_fault(kind, numbers, why);
  EXPECT_TRUE(fault) << why;
  return {0, fault.value_or(hwparts::Fault{}), until};
}

// Writes before the end of a fault are lost, later ones are not.
void expect_a_clean_end(const hwparts::ActiveFault& fault) {
  Simulation simulation(two_link_with_tick(1'000'000));
  const auto input = [&] { return simulation.parts()[0].controller_inputs[0]; };
  const double before = input();
  ASSERT_TRUE(simulation.inject(fault).done());
  while (simulation.tick_count() < fault.until_tick - 1) simulation.tick();
  simulation.write_inputs(0, 0, std::vector{0.1});
  simulation.tick();
  EXPECT_EQ(input(), before);
  EXPECT_TRUE(simulation.faults().empty());
  simulation.write_inputs(0, 0, std::vector{0.2});
  simulation.tick();
  EXPECT_EQ(input(), 0.2);
}

TEST(FaultThatEnds, LetsASilentPartHearFromItsFirstTickOn) {
  expect_a_clean_end(fault_of_robot("part_silent", {}, 20));
}

TEST(FaultThatEnds, LosesNoWriteForTheFirstTickWithoutLoss) {
  expect_a_clean_end(fault_of_robot("network_loss", {{"share", 1.0}}, 20));
}

TEST(FaultTooLargeForTheTick, IsRefusedAndChangesNothing) {
  Simulation simulation(two_link_with_tick(1'000));
  const auto before = simulation.state_hash();
  const std::vector<double> longest{1000.0, 0.0}, shorter{10.0, 0.0};
  const auto outcome = apply(simulation, recording::InjectFault{"robot", "network_delay", longest, 0});
  EXPECT_EQ(outcome.refusal(), Refusal::kBadValue);
  EXPECT_NE(outcome.text().find("'robot' would have 1000002 ticks under way"), std::string::npos);
  EXPECT_EQ(simulation.state_hash(), before);
  EXPECT_EQ(apply(simulation, recording::InjectFault{"robot", "network_delay", shorter, 0}).text(), "");
}

TEST(FaultTooLargeForTheTick, IsNotRestoredEither) {
  Simulation slow(two_link_with_tick(1'000'000)), fast(two_link_with_tick(1'000));
  ASSERT_TRUE(slow.inject(fault_of_robot("network_delay", {{"ms", 1000}}, 0)).done());
  recording::State whole;
  slow.keep(whole);
  const auto outcome = fast.restore(whole);
  EXPECT_EQ(outcome.refusal(), Refusal::kDamaged);
  EXPECT_NE(outcome.text().find("ticks under way"), std::string::npos);
  EXPECT_TRUE(fast.faults().empty());
}

}  // namespace
}  // namespace visum::cycle
