#include "tests/dynamics/contract/scenes.h"
#include "tests/dynamics/rollback.h"

namespace visum::dynamics::testing {
namespace {

class Determinism : public Contract {
 protected:
  Lab busy_lab() const { return Lab(busy_model(GetParam().engine)); }
};
VISUM_INSTANTIATE_CONTRACT(Determinism);

TEST_P(Determinism, TheSameWorldTwiceGivesTheSameBits) {
  Lab first = busy_lab(), second = busy_lab();
  for (Lab* lab : {&first, &second}) {
    set_busy_drives(*lab);
    lab->run_ticks(600);
  }
  EXPECT_FALSE(first.contacts.empty());
  EXPECT_EQ(first.hash(), second.hash());
}

TEST_P(Determinism, TwoWorldsInOneProcessDoNotDisturbEachOther) {
  Lab alone = busy_lab(), first = busy_lab(), second = busy_lab();
  for (Lab* lab : {&alone, &first, &second}) set_busy_drives(*lab);
  second.run_ticks(37);
  for (int i = 0; i < 600; ++i) {
    first.run_ticks(1);
    second.run_ticks(1);
  }
  alone.run_ticks(600);
  EXPECT_EQ(alone.hash(), first.hash());
}

TEST_P(Determinism, RestoringAndGoingOnGivesTheSameBits) {
  Lab lab = busy_lab();
  set_busy_drives(lab);
  lab.run_ticks(300);
  const world::WorldState saved = lab.state;
  lab.run_ticks(400);
  const std::uint64_t straight = lab.hash();
  lab.state = saved;
  lab.run_ticks(400);
  EXPECT_EQ(lab.hash(), straight);
}

TEST_P(Determinism, AFreshEngineGoesOnFromARestoredStateWithTheSameBits) {
  Lab lab = busy_lab(), fresh = busy_lab();
  for (Lab* each : {&lab, &fresh}) set_busy_drives(*each);
  lab.run_ticks(300);
  fresh.state = lab.state;
  for (int i = 0; i < 400; ++i) {
    lab.run_ticks(1);
    fresh.run_ticks(1);
    ASSERT_EQ(lab.hash(), fresh.hash()) << "tick " << i;
  }
}

TEST_P(Determinism, RollingBackSevenTicksAtEachTickChangesNothing) {
  Lab straight = busy_lab(), rolled = busy_lab();
  for (Lab* lab : {&straight, &rolled}) set_busy_drives(*lab);
  EXPECT_EQ(first_difference_when_rolled_back(straight, rolled, 300), std::nullopt);
}

}  // namespace
}  // namespace visum::dynamics::testing
