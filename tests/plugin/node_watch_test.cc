// Calls of plug-ins that do not come back.
#include <gtest/gtest.h>

#include <future>

#include "protocol/plugin/foreign_call.h"
#include "server/programs/node_watch.h"

namespace visum::programs {
namespace {

using namespace std::chrono_literals;
using Verdict = CallWatch::Verdict;

TEST(CallWatch, TellsOnceAfterASecondAndGivesUpOnceAtTheLimit) {
  CallWatch watch(3s);
  const char* node = "agent 'hand'";
  const plugin::ForeignCall call(node);
  std::vector<Verdict> verdicts;
  for (int i = 0; i < 9; ++i) verdicts.push_back(watch.look(500ms));
  const auto fine = Verdict::kFine;
  EXPECT_EQ(verdicts,
            (std::vector{fine, fine, Verdict::kTold, fine, fine, fine, Verdict::kLost, fine, fine}));
  EXPECT_EQ(watch.stuck().node, node);
  EXPECT_EQ(watch.stuck().since, 4s);
}

TEST(CallWatch, CallsThatComeBackAreFineHoweverManyThereAre) {
  CallWatch watch(3s);
  const char* node = "agent 'hand'";
  for (int i = 0; i < 20; ++i) {
    const plugin::ForeignCall call(node);
    EXPECT_EQ(watch.look(900ms), Verdict::kFine);
  }
  EXPECT_EQ(watch.look(10s), Verdict::kFine);
  EXPECT_EQ(watch.stuck().node, "");
}

TEST(CallWatch, TellsOfOneThatHasComeBack) {
  CallWatch watch(0s);
  const char* node = "sensor 'eye'";
  {
    const plugin::ForeignCall call(node);
    watch.look(1s);
    EXPECT_EQ(watch.look(1h), Verdict::kTold) << "without a limit";
    EXPECT_EQ(watch.look(1h), Verdict::kFine);
  }
  EXPECT_EQ(watch.look(1s), Verdict::kBack);
  EXPECT_EQ(watch.look(1s), Verdict::kFine);
}

TEST(CallWatch, NamesTheInnerOfTwo) {
  CallWatch watch(10s);
  const char *outer = "agent 'hand'", *inner = "part 'motor'";
  const plugin::ForeignCall call(outer);
  {
    const plugin::ForeignCall within(inner);
    watch.look(1s);
    watch.look(1s);
    EXPECT_EQ(watch.stuck().node, inner);
  }
  watch.look(1s);
  watch.look(1s);
  EXPECT_EQ(watch.stuck().node, outer);
}

TEST(NodeWatch, GivesUpFromAThreadOfItsOwn) {
  std::promise<std::string> lost;
  const char* node = "engine 'euler'";
  const plugin::ForeignCall call(node);
  NodeWatch watch(200ms, [&](const StuckNode& stuck) { lost.set_value(stuck.node); });
  EXPECT_EQ(lost.get_future().get(), node);
}

}  // namespace
}  // namespace visum::programs
