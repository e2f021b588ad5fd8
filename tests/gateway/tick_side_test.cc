// The tick's side and inputs that were on their way when a lease was lost or the world changed.
#include "server/gateway/tick_side.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "server/scene/scene.h"

namespace visum::gateway {
namespace {

constexpr std::uint32_t kDesired = 0;  // port: of the first joint

class Inputs : public ::testing::Test {
 protected:
  void grant(std::uint64_t epoch, std::int64_t deadline_ticks) {
    auto* input = mailbox.blank_input();
    input->kind = Input::Kind::kLeaseGranted;
    input->epoch = epoch;
    input->deadline_ticks = deadline_ticks;
    mailbox.send(input);
  }
  void write(std::uint64_t epoch, double angle) {
    auto* input = mailbox.blank_input();
    input->kind = Input::Kind::kWrite;
    input->epoch = epoch;
    input->first_port = kDesired;
    input->values = {angle};
    mailbox.send(input);
  }
  void lose(std::uint64_t epoch) {
    auto* input = mailbox.blank_input(true);
    input->kind = Input::Kind::kLeaseLost;
    input->epoch = epoch;
    mailbox.send(input);
  }
  void run(int ticks) {
    for (int i = 0; i < ticks; ++i) {
      tick_side.empty_mailbox();
      tick_side.tick();
    }
  }
  double desired() const { return simulation.parts()[0].controller_inputs[kDesired]; }

  cycle::Simulation simulation{
      scene::load_scene(std::filesystem::path(VISUM_SOURCE_DIR) / "models/scenes/two_link.yaml")};
  Mailbox mailbox{64};
  TickSide tick_side{simulation, mailbox, true};
};

TEST_F(Inputs, AWriteThatComesAfterItsDeadlineIsNotDone) {
  grant(1, 5);
  write(1, 0.25);
  run(20);
  ASSERT_EQ(desired(), 0.25);
  write(1, 0.5);  // accepted before the sessions' side knew of the loss
  run(1);
  EXPECT_EQ(desired(), 0.25);
}

TEST_F(Inputs, TheNextLeaseWritesAgain) {
  grant(1, 5);
  run(20);
  grant(2, 0);
  write(2, 0.5);
  run(1);
  EXPECT_EQ(desired(), 0.5);
}

TEST_F(Inputs, OfALossAndAGrantAtOnceTheNewLeaseActs) {
  grant(1, 0);
  write(1, 0.25);
  lose(1);
  grant(2, 0);
  write(2, 0.5);
  run(1);
  EXPECT_EQ(desired(), 0.5);
}

TEST_F(Inputs, AfterAReleaseNoDeadlineIsWatched) {
  grant(1, 5);
  auto* release = mailbox.blank_input();
  release->kind = Input::Kind::kLeaseReleased;
  release->epoch = 1;
  mailbox.send(release);
  run(20);
  Notice notice;
  EXPECT_FALSE(mailbox.next_notice(notice));
}

}  // namespace
}  // namespace visum::gateway
