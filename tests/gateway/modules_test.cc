// The modules that controllers announce, and overrides on their way to them: the server relays both, and the
// world knows nothing of them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <tuple>

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

// The ramp has a parameter of each type, and the part a blackboard.
AnnounceModules with_parameters() {
  auto announced = motion();
  announced.modules[1].parameters = {{"Speed", "rad/s", "highest speed", 0.5, 0.0, 2.0, {}},
                                     {"Steps", "", "", std::int64_t{3}, 1.0, 9.0, {}},
                                     {"Loud", "", "", false, 0.0, 0.0, {}},
                                     {"Mode", "", "", std::string("slow"), 0.0, 0.0, {"slow", "fast"}},
                                     {"Note", "", "", std::string(), 0.0, 0.0, {}}};
  announced.blackboards = {{"Way", "application/x-float64", 16, 0, 160, true}};
  return announced;
}

ReportModules values(double speed) {
  return {"motion",
          10,
          {{{1.0}, {2.0}, {}, {}},
           {{1.0}, {2.0}, {0.5}, {}, 0, 0, {}, {speed, std::int64_t{3}, false, "slow", ""}}},
          {{2, 5, std::vector<std::byte>(32)}}};
}

TEST(ModuleParameters, AreRelayedWithTheirValuesAsBlackboardsAre) {
  RunningDaemon daemon(scene::ClockKind::kLockstep);
  auto controller = daemon.connect("motion"), viewer = daemon.connect("viewer", Role::kObserver);
  controller.request(with_parameters());
  controller.request(values(0.75));
  const auto part = viewer.request_as<ModuleList>(ListModules{"motion"}).parts.at(0);
  const auto& speed = part.announced.modules.at(1).parameters.at(0);
  EXPECT_EQ(std::tie(speed.name, speed.unit, speed.maximum), std::tuple("Speed", "rad/s", 2.0));
  EXPECT_EQ(part.reported.modules.at(1).parameters.at(0), ParameterValue(0.75));
  EXPECT_EQ(part.announced.blackboards.at(0).capacity, 160u);
  EXPECT_EQ(part.reported.blackboards.at(0).elements, 2u);
  EXPECT_EQ(part.reported.blackboards.at(0).head.size(), 32u);
}

TEST(ModuleParameters, AnOrderReachesTheControllerAndIsTold) {
  RunningDaemon daemon(scene::ClockKind::kLockstep);
  auto controller = daemon.connect("motion"), tester = daemon.connect("tester");
  controller.request(with_parameters());
  tester.request(SubscribeEvents{});
  tester.request(SetModuleParameter{"motion", "Ramp", "Speed", std::int64_t{1}});
  const auto heard = controller.next(std::chrono::seconds(5));
  ASSERT_TRUE(heard && std::holds_alternative<SetModuleParameter>(*heard));
  EXPECT_EQ(std::get<SetModuleParameter>(*heard).name, "Speed");
  const auto told = tester.next(std::chrono::seconds(5));
  ASSERT_TRUE(told && std::holds_alternative<Event>(*told));
  EXPECT_EQ(std::get<Event>(*told).kind, "module_parameter");
  EXPECT_EQ(std::get<Event>(*told).text, "motion/Ramp/Speed = 1");
}

TEST(ModuleParameters, AnOrderThatCannotBeIsRefusedWithItsReason) {
  RunningDaemon daemon(scene::ClockKind::kLockstep);
  auto controller = daemon.connect("motion"), tester = daemon.connect("tester");
  controller.request(with_parameters());
  const auto refusal = [&](const std::string& path, const std::string& name, const ParameterValue& value) {
    return std::string(refusal_of([&] {
                         tester.request(SetModuleParameter{"motion", path, name, value});
                       }).what());
  };
  EXPECT_EQ(refusal("Ramp", "Speed", 2.5), "'Speed' must be within 0 and 2");
  EXPECT_EQ(refusal("Ramp", "Speed", std::nan("")), "'Speed' must be within 0 and 2");
  EXPECT_EQ(refusal("Ramp", "Steps", 2.0), "'Steps' is a whole number");
  EXPECT_EQ(refusal("Ramp", "Loud", 1.0), "'Loud' is true or false");
  EXPECT_EQ(refusal("Ramp", "Mode", "fats"), "'Mode' must be one of: slow, fast");
  EXPECT_EQ(refusal("Ramp", "Note", std::string(1025, 'x')), "a text has at most 1024 bytes");
  EXPECT_THAT(refusal("Ramp", "Sped", 1.0), HasSubstr("did you mean 'Speed'?"));
  EXPECT_THAT(refusal("Rampe", "Speed", 1.0), HasSubstr("did you mean 'Ramp'?"));
  EXPECT_THAT(refusal("", "Speed", 1.0), HasSubstr("there is no parameter 'Speed'"));
  EXPECT_FALSE(controller.next(std::chrono::milliseconds(0)));
}

TEST(ModuleParameters, WhatCannotBeAnnouncedIsRefusedByItsPlace) {
  RunningDaemon daemon(scene::ClockKind::kLockstep);
  auto controller = daemon.connect("motion");
  const auto refusal = [&](auto spoil) {
    auto announced = with_parameters();
    spoil(announced);
    return std::string(refusal_of([&] { controller.request(announced); }).what());
  };
  EXPECT_EQ(refusal([](auto& a) { a.modules[1].parameters[1].name = "Speed"; }),
            "the parameter 'Speed' of 'Ramp': it is there twice");
  EXPECT_THAT(refusal([](auto& a) { a.modules[1].parameters[1].unit = "\n"; }),
              HasSubstr("control characters"));
  EXPECT_THAT(refusal([](auto& a) { a.modules[1].parameters[0].maximum = std::nan(""); }),
              HasSubstr("its range is no range"));
  EXPECT_THAT(refusal([](auto& a) { a.modules[1].parameters[4].value = std::string(1025, 'x'); }),
              HasSubstr("its text is too long"));
  EXPECT_EQ(refusal([](auto& a) { a.blackboards.push_back(a.blackboards[0]); }),
            "the blackboard 'Way' is there twice");
  EXPECT_EQ(refusal([](auto& a) { a.blackboards.resize(65); }), "more than 64 blackboards");
  controller.request(with_parameters());
  for (const auto& spoil : std::vector<std::function<void(ReportModules&)>>{
           [](auto& r) { r.modules[1].parameters.pop_back(); },
           [](auto& r) { r.modules[1].parameters[0] = true; },
           [](auto& r) { r.modules[1].parameters[4] = std::string(1025, 'x'); },
           [](auto& r) { r.blackboards.clear(); }, [](auto& r) { r.blackboards[0].head.resize(1025); }}) {
    auto reported = values(0.5);
    spoil(reported);
    EXPECT_THAT(refusal_of([&] { controller.request(reported); }).what(), HasSubstr("do not fit"));
  }
}

}  // namespace
}  // namespace visum::gateway
