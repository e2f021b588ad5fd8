// The modules that controllers announce, and overrides on their way to them: the server relays both, and the
// world knows nothing of them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/gateway/running_daemon.h"

namespace visum::gateway {
namespace {

using namespace protocol;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

AnnounceModules motion() {
  return {"motion",
          5'000'000,
          {{"", true, {"Target"}, {"Desired Angle 1"}, {}, {}},
           {"Ramp", false, {"Target"}, {"Desired Angle 1"}, {"Actual Angle 1"}, {}}},
          {{{"motion", "", ModuleVector::kControllerInput, 0},
            {"motion", "Ramp", ModuleVector::kControllerInput, 0},
            1},
           {{"motion", "", ModuleVector::kControllerOutput, 0},
            {"arm", "", ModuleVector::kControllerInput, 0},
            1}}};
}

TEST(Modules, AreRelayedWithTheirNewestValues) {
  RunningDaemon daemon(scene::ClockKind::kLockstep);
  auto controller = daemon.connect("motion"), viewer = daemon.connect("viewer", Role::kObserver);
  EXPECT_TRUE(viewer.request_as<ModuleList>(ListModules{}).parts.empty());
  const auto hash = viewer.request_as<ServerStatus>(Status{}).state_hash;
  controller.request(motion());
  controller.request(
      ReportModules{"motion", 10, {{{1.0}, {2.0}, {}, {}}, {{1.0}, {2.0}, {0.5}, {}, 1500, 700}}});
  const auto list = viewer.request_as<ModuleList>(ListModules{"motion"});
  ASSERT_EQ(list.parts.size(), 1u);
  EXPECT_EQ(list.parts[0].client, "motion");
  EXPECT_EQ(list.parts[0].announced.modules.at(1).path, "Ramp");
  EXPECT_EQ(list.parts[0].reported.modules.at(1).control_ns, 1500);
  const auto again = viewer.request_as<ModuleList>(ListModules{"", list.revision});
  EXPECT_TRUE(again.parts.at(0).announced.modules.empty());
  EXPECT_THAT(again.parts.at(0).reported.modules.at(1).sensor_inputs, ElementsAre(0.5));
  EXPECT_EQ(viewer.request_as<ServerStatus>(Status{}).state_hash, hash);
}

TEST(Modules, GoWithTheirSession) {
  RunningDaemon daemon(scene::ClockKind::kLockstep);
  auto viewer = daemon.connect("viewer", Role::kObserver);
  {
    auto controller = daemon.connect("motion");
    controller.request(motion());
    auto other = daemon.connect("other");
    EXPECT_THAT(refusal_of([&] { other.request(motion()); }).what(),
                HasSubstr("announced by 'motion' already"));
  }
  for (int tries = 0; tries < 1000; ++tries)
    if (viewer.request_as<ModuleList>(ListModules{}).parts.empty()) return;
  FAIL() << "the part is still there";
}

TEST(Modules, WhatCannotBeIsRefusedByItsPlace) {
  RunningDaemon daemon(scene::ClockKind::kLockstep);
  auto controller = daemon.connect("motion");
  const auto refusal = [&](const Request& request) {
    return std::string(refusal_of([&] { controller.request(request); }).what());
  };
  auto twice = motion();
  twice.modules.push_back(twice.modules[1]);
  EXPECT_EQ(refusal(twice), "the module 'Ramp' is there twice");
  auto lost = motion();
  lost.edges[0].to.path = "Ramq";
  EXPECT_THAT(refusal(lost), HasSubstr("the module 'Ramq', which is not announced"));
  auto wide = motion();
  wide.edges[0].count = 2;
  EXPECT_THAT(refusal(wide), HasSubstr("goes beyond the Controller Input"));
  EXPECT_THAT(refusal(ReportModules{"motion", 0, {}}), HasSubstr("has not announced the part"));
  controller.request(motion());
  EXPECT_THAT(refusal(ReportModules{"motion", 0, {{{1.0}, {}, {}, {}}}}), HasSubstr("do not fit"));
  EXPECT_THAT(refusal(ListModules{"motoin"}), HasSubstr("did you mean 'motion'?"));
}

TEST(Modules, AnOverrideReachesTheControllerAndIsTold) {
  RunningDaemon daemon(scene::ClockKind::kLockstep);
  auto controller = daemon.connect("motion"), tester = daemon.connect("tester");
  controller.request(motion());
  tester.request(SubscribeEvents{});
  tester.request(OverrideModulePort{"motion", "Ramp", "Actual Angle 1", 0.25});
  const auto heard = controller.next(std::chrono::seconds(5));
  ASSERT_TRUE(heard && std::holds_alternative<OverrideModulePort>(*heard));
  EXPECT_EQ(std::get<OverrideModulePort>(*heard).value, 0.25);
  const auto told = tester.next(std::chrono::seconds(5));
  ASSERT_TRUE(told && std::holds_alternative<Event>(*told));
  EXPECT_EQ(std::get<Event>(*told).kind, "override");
  EXPECT_EQ(std::get<Event>(*told).text, "motion/Ramp/Actual Angle 1 holds 0.25");
  EXPECT_THAT(refusal_of([&] {
                tester.request(OverrideModulePort{"motion", "Ramp", "Target", 0.25});
              }).what(),
              HasSubstr("there is no sensor input 'Target'"));
  EXPECT_THAT(refusal_of([&] {
                tester.request(OverrideModulePort{"motion", "", "Target", 0.25});
              }).what(),
              HasSubstr("there is no module ''"));
}

}  // namespace
}  // namespace visum::gateway
