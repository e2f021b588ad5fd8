// Ports, leases, parameters and blackboards, as a client sees them.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "tests/gateway/running_daemon.h"

namespace visum::gateway {
namespace {

using namespace protocol;

TEST(Ports, AreListedAndDescribed) {
  RunningDaemon daemon(scene::ClockKind::kLockstep);
  auto client = daemon.connect("reader", Role::kObserver);
  const auto parts = client.request_as<PartList>(ListParts{}).parts;
  ASSERT_EQ(parts.size(), 1u);
  EXPECT_EQ(parts[0].name, "arm");
  EXPECT_EQ(parts[0].kind, "amtec_arm");
  const auto arm = describe_arm(client);
  EXPECT_EQ(arm.controller_inputs.at(0).name, "Desired Angle 1");
  EXPECT_EQ(arm.controller_inputs.at(0).unit, "rad");
  EXPECT_EQ(arm.sensor_outputs.at(0).name, "Actual Angle 1");
}

TEST(Ports, AWrittenAngleIsReached) {
  RunningDaemon daemon(scene::ClockKind::kLockstep);
  auto client = daemon.connect("mover");
  client.request(AcquireLease{"arm", 0, false});
  client.request(Join{});
  const double from = sensor(client, "Actual Angle 1");
  client.request(Write{"arm", 0, {from + 0.1}, 1});
  advance(client, 3000);
  EXPECT_NEAR(sensor(client, "Actual Angle 1"), from + 0.1, 2e-3);
}

TEST(Ports, RefusalsNameTheNearestName) {
  RunningDaemon daemon(scene::ClockKind::kLockstep);
  auto client = daemon.connect("typist");
  const auto error = refusal_of([&] { client.request(Read{"amr"}); });
  EXPECT_EQ(error.code(), ErrorCode::kUnknownName);
  EXPECT_STREQ(error.what(), "there is no part 'amr'; did you mean 'arm'?");
}

TEST(Leases, WritingNeedsOneAndRefusalsNameTheOwner) {
  RunningDaemon daemon(scene::ClockKind::kLockstep);
  auto first = daemon.connect("first"), second = daemon.connect("second");
  EXPECT_EQ(refusal_of([&] { first.request(Write{"arm", 0, {0.0}, 0}); }).code(), ErrorCode::kNoLease);
  first.request(AcquireLease{"arm", 0, false});
  const auto taken = refusal_of([&] { second.request(AcquireLease{"arm", 0, false}); });
  EXPECT_EQ(taken.code(), ErrorCode::kLeased);
  EXPECT_EQ(taken.owner(), "first");
  const auto write = refusal_of([&] { second.request(Write{"arm", 0, {0.0}, 0}); });
  EXPECT_EQ(write.code(), ErrorCode::kNoLease);
  EXPECT_EQ(write.owner(), "first");
  first.request(ReleaseLease{"arm"});
  second.request(AcquireLease{"arm", 0, false});
}

TEST(Leases, OnlyAnAdminTakesOne) {
  RunningDaemon daemon(scene::ClockKind::kLockstep);
  auto holder = daemon.connect("holder"), rival = daemon.connect("rival");
  auto admin = daemon.connect("boss", Role::kAdmin);
  holder.request(AcquireLease{"arm", 0, false});
  EXPECT_EQ(refusal_of([&] { rival.request(AcquireLease{"arm", 0, true}); }).code(), ErrorCode::kForbidden);
  admin.request(AcquireLease{"arm", 0, true});
  EXPECT_EQ(refusal_of([&] { holder.request(Write{"arm", 0, {0.0}, 0}); }).owner(), "boss");
}

TEST(Leases, AGoodReleaseLeavesTheArmGoingWhereItWasSent) {
  RunningDaemon daemon(scene::ClockKind::kLockstep);
  auto world = daemon.connect("stepper");
  world.request(Join{});
  const double from = sensor(world, "Actual Angle 1");
  {
    auto client = daemon.connect("script");
    client.request(AcquireLease{"arm", 0, false});
    client.request(Write{"arm", 0, {from + 0.2}, 0});
    client.request(ReleaseLease{"arm"});
  }
  advance(world, 4000);
  EXPECT_NEAR(sensor(world, "Actual Angle 1"), from + 0.2, 2e-3);
}

TEST(Leases, AControllerThatIsGoneStopsTheArmUntilReset) {
  RunningDaemon daemon(scene::ClockKind::kLockstep);
  auto world = daemon.connect("stepper");
  world.request(Join{});
  const double from = sensor(world, "Actual Angle 1");
  {
    auto client = daemon.connect("doomed");
    client.request(AcquireLease{"arm", 0, false});
    client.request(Write{"arm", 0, {from + 1.0}, 0});
    advance(world, 500);
  }
  while (!world.request_as<PartList>(ListParts{}).parts[0].lease_owner.empty()) continue;
  advance(world, 2000);
  const double stopped = sensor(world, "Actual Angle 1");
  EXPECT_LT(stopped, from + 0.5) << "it did not go on to its target";
  EXPECT_NE(static_cast<unsigned>(sensor(world, "Module State 1")) & 1u, 0u) << "the fault shows";

  auto next = daemon.connect("next");
  next.request(AcquireLease{"arm", 0, false});
  const auto reset = static_cast<std::uint32_t>(index_of(describe_arm(next).controller_inputs, "Reset"));
  next.request(Write{"arm", reset, {1.0}, 0});
  advance(world, 200);
  EXPECT_EQ(static_cast<unsigned>(sensor(world, "Module State 1")) & 1u, 0u) << "Reset clears it";
  EXPECT_NEAR(sensor(world, "Actual Angle 1"), stopped, 5e-3) << "and does not jump to the old target";
  next.request(Write{"arm", 0, {stopped - 0.1}, 0});
  advance(world, 3000);
  EXPECT_NEAR(sensor(world, "Actual Angle 1"), stopped - 0.1, 5e-3);
  next.request(ReleaseLease{"arm"});
}

TEST(Leases, ADeadlineCountsSimulatedTime) {
  RunningDaemon daemon(scene::ClockKind::kLockstep);
  auto client = daemon.connect("late");
  client.request(AcquireLease{"arm", 50'000'000, false});
  client.request(Join{});
  for (int i = 0; i < 5; ++i) {
    client.request(Write{"arm", 0, {0.1}, 0});
    advance(client, 50);
  }
  EXPECT_EQ(client.request_as<PartList>(ListParts{}).parts[0].lease_owner, "late");
  advance(client, 60);
  EXPECT_EQ(client.request_as<PartList>(ListParts{}).parts[0].lease_owner, "");
  EXPECT_EQ(refusal_of([&] { client.request(Write{"arm", 0, {0.1}, 0}); }).code(), ErrorCode::kNoLease);
}

TEST(Leases, ADeadlineInTheFarFutureIsNone) {
  RunningDaemon daemon(scene::ClockKind::kLockstep);
  auto client = daemon.connect("patient");
  client.request(AcquireLease{"arm", std::numeric_limits<std::int64_t>::max(), false});
  client.request(Join{});
  advance(client, 50);
  EXPECT_EQ(client.request_as<PartList>(ListParts{}).parts[0].lease_owner, "patient");
}

TEST(Writes, AreAllOrNothing) {
  RunningDaemon daemon(scene::ClockKind::kLockstep);
  auto client = daemon.connect("writer");
  client.request(AcquireLease{"arm", 0, false});
  client.request(Join{});
  advance(client, 1);
  const auto before = client.request_as<PartSample>(Read{"arm"}).controller_inputs;
  EXPECT_EQ(refusal_of([&] {
              client.request(Write{"arm", 0, {0.1, 0.2, 1e9}, 0});
            }).code(),
            ErrorCode::kBadValue);
  EXPECT_EQ(refusal_of([&] {
              client.request(Write{"arm", 20, {0, 0, 0, 0}, 0});
            }).code(),
            ErrorCode::kBadValue);
  EXPECT_EQ(refusal_of([&] {
              client.request(Write{"arm", 4'000'000'000, {0.0}, 0});
            }).code(),
            ErrorCode::kBadValue);
  EXPECT_EQ(refusal_of([&] { client.request(Write{"arm", 0, {}, 0}); }).code(), ErrorCode::kBadValue);
  advance(client, 1);
  EXPECT_EQ(client.request_as<PartSample>(Read{"arm"}).controller_inputs, before);
}

// A network that held up the writes delivers them all at once.
TEST(Writes, ManyAtOnceAreAllAcceptedAndTheLastOfEachPortComesIntoForce) {
  RunningDaemon daemon(scene::ClockKind::kRealtime);
  auto admin = daemon.connect("admin", Role::kAdmin), client = daemon.connect("writer");
  client.request(AcquireLease{"arm", 0, false});
  admin.request(Pause{});
  constexpr std::uint64_t kMany = 500;
  std::vector<std::uint64_t> ids;
  for (std::uint64_t i = 1; i <= kMany; ++i) {
    // Joints 1 and 3, and joint 2 once.
    const std::uint32_t port = i % 2 == 0 ? 0 : i == 1 ? 1 : 2;
    ids.push_back(client.send(Write{"arm", port, {1e-4 * static_cast<double>(i)}, i}));
  }
  for (const auto id : ids) EXPECT_NO_THROW(client.wait(id));
  EXPECT_EQ(refusal_of([&] { client.request(Write{"arm", 0, {0.0}, kMany}); }).code(), ErrorCode::kStale);
  admin.request(Step{1});
  const auto inputs = client.request_as<PartSample>(Read{"arm"}).controller_inputs;
  EXPECT_EQ(inputs[0], 1e-4 * kMany);
  EXPECT_EQ(inputs[1], 1e-4);
  EXPECT_EQ(inputs[2], 1e-4 * (kMany - 1));
  EXPECT_EQ(admin.request_as<ServerStatus>(Status{}).refused, 1u);
}

TEST(Writes, OfManyAtOnceTheLastHoldsAfterTheRelease) {
  RunningDaemon daemon(scene::ClockKind::kRealtime);
  auto admin = daemon.connect("admin", Role::kAdmin), client = daemon.connect("writer");
  client.request(AcquireLease{"arm", 0, false});
  admin.request(Pause{});
  for (int i = 1; i <= 20; ++i) client.request(Write{"arm", 0, {0.01 * i}, 0});
  client.request(ReleaseLease{"arm"});
  admin.request(Step{1});
  EXPECT_EQ(admin.request_as<PartSample>(Read{"arm"}).controller_inputs[0], 0.01 * 20);
}

// A member stands in a debugger while a joystick beside it goes on writing.
TEST(Writes, ToAWorldThatStandsLeaveRoomForOthersAndComeIntoForceAtItsNextTick) {
  RunningDaemon daemon(scene::ClockKind::kLockstep);
  auto member = daemon.connect("member", Role::kAdmin), writer = daemon.connect("writer");
  member.request(Join{});
  writer.request(AcquireLease{"arm"});
  constexpr std::uint64_t kMany = 2000;
  std::vector<std::uint64_t> ids;
  for (std::uint64_t i = 1; i <= kMany; ++i)
    ids.push_back(writer.send(Write{"arm", i % 2 == 0 ? 0u : 2u, {1e-4 * static_cast<double>(i)}, i}));
  for (const auto id : ids) EXPECT_NO_THROW(writer.wait(id));
  EXPECT_NO_THROW(member.request(PushBody{"box", {0, 0, 1}, {}, {}, 1'000'000}));
  advance(member, 1);
  const auto inputs = member.request_as<PartSample>(Read{"arm"}).controller_inputs;
  EXPECT_EQ(inputs[0], 1e-4 * kMany);
  EXPECT_EQ(inputs[2], 1e-4 * (kMany - 1));
  EXPECT_NO_THROW(writer.request(ReleaseLease{"arm"}));
}

// Like all writes before a reset, they are undone by it.
TEST(Writes, OfManyAtOnceNoneOutlivesAReset) {
  RunningDaemon daemon(scene::ClockKind::kRealtime);
  auto admin = daemon.connect("admin", Role::kAdmin), client = daemon.connect("writer");
  const auto initial = client.request_as<PartSample>(Read{"arm"}).controller_inputs[0];
  client.request(AcquireLease{"arm", 0, false});
  admin.request(Pause{});
  for (int i = 1; i <= 20; ++i) client.request(Write{"arm", 0, {initial + 0.01 * i}, 0});
  admin.request(Reset{});
  admin.request(Step{3});
  EXPECT_EQ(admin.request_as<PartSample>(Read{"arm"}).controller_inputs[0], initial);
}

// Late writes of one controller do not come between the commands of the next.
TEST(Writes, OfManyAtOnceNoneIsLeftToTheNextHolder) {
  RunningDaemon daemon(scene::ClockKind::kRealtime);
  auto admin = daemon.connect("admin", Role::kAdmin), client = daemon.connect("writer");
  client.request(AcquireLease{"arm", 0, false});
  admin.request(Pause{});
  for (int i = 1; i <= 20; ++i) client.request(Write{"arm", 0, {0.01 * i}, 0});
  admin.request(AcquireLease{"arm", 0, true});
  admin.request(Write{"arm", 0, {0.5}, 0});
  admin.request(Step{3});
  EXPECT_EQ(admin.request_as<PartSample>(Read{"arm"}).controller_inputs[0], 0.5);
}

TEST(Writes, AnOlderSequenceIsStale) {
  RunningDaemon daemon(scene::ClockKind::kLockstep);
  auto client = daemon.connect("writer");
  client.request(AcquireLease{"arm", 0, false});
  client.request(Write{"arm", 0, {0.1}, 7});
  EXPECT_EQ(refusal_of([&] { client.request(Write{"arm", 0, {0.2}, 7}); }).code(), ErrorCode::kStale);
}

TEST(Parameters, AreReadByAnyoneAndSetByTheHolder) {
  RunningDaemon daemon(scene::ClockKind::kLockstep);
  auto client = daemon.connect("tuner"), reader = daemon.connect("reader", Role::kObserver);
  const auto parameters = reader.request_as<ParameterList>(GetParameters{"arm"}).parameters;
  const auto tunable = std::find_if(parameters.begin(), parameters.end(), [](const Parameter& parameter) {
    return !parameter.read_only && std::holds_alternative<double>(parameter.value);
  });
  ASSERT_NE(tunable, parameters.end());
  const SetParameter to_maximum{"arm", tunable->name, tunable->maximum};
  EXPECT_EQ(refusal_of([&] { client.request(to_maximum); }).code(), ErrorCode::kNoLease);
  client.request(AcquireLease{"arm", 0, false});
  client.request(to_maximum);
  EXPECT_EQ(refusal_of([&] {
              client.request(SetParameter{"arm", tunable->name, tunable->maximum * 2 + 1});
            }).code(),
            ErrorCode::kBadValue);
  EXPECT_EQ(refusal_of([&] {
              client.request(SetParameter{"arm", "nonsense", 1.0});
            }).code(),
            ErrorCode::kUnknownName);
  const auto after = reader.request_as<ParameterList>(GetParameters{"arm"}).parameters;
  const auto tuned = std::ranges::find(after, tunable->name, &Parameter::name);
  EXPECT_EQ(std::get<double>(tuned->value), tunable->maximum);
}

TEST(Blackboards, AreReadInPartAndReadOnlyOnesStay) {
  RunningDaemon daemon(scene::ClockKind::kLockstep);
  auto client = daemon.connect("reader");
  const auto boards = describe_arm(client).blackboards;
  ASSERT_FALSE(boards.empty());
  const auto whole = client.request_as<BlackboardData>(ReadBlackboard{"arm", boards[0].name, 0, 0});
  ASSERT_GT(whole.data.size(), 4u);
  const auto piece = client.request_as<BlackboardData>(ReadBlackboard{"arm", boards[0].name, 1, 3});
  EXPECT_EQ(piece.data, std::vector(whole.data.begin() + 1, whole.data.begin() + 4));
  EXPECT_EQ(piece.total, whole.data.size());
  const auto most = std::numeric_limits<std::uint64_t>::max();
  EXPECT_EQ(refusal_of([&] {
              client.request(ReadBlackboard{"arm", boards[0].name, most, most});
            }).code(),
            ErrorCode::kBadValue);
  client.request(AcquireLease{"arm", 0, false});
  EXPECT_EQ(refusal_of([&] {
              client.request(WriteBlackboard{"arm", boards[0].name, 0, {std::byte{1}}});
            }).code(),
            ErrorCode::kForbidden);
}

}  // namespace
}  // namespace visum::gateway
