// Every number that a client can send × NaN, infinities, 1e308: refused with a code, and the world's hash is
// as if nothing had come.
#include <gtest/gtest.h>

#include <limits>

#include "tests/gateway/running_daemon.h"

namespace visum::gateway {
namespace {

using namespace protocol;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN(),
                 kInf = std::numeric_limits<double>::infinity();
constexpr double kBad[] = {kNaN, -kNaN, kInf, -kInf, 1e308, -1e308};

// Sends every bad number in every place, and counts the refusals.
int bombard(Connection& client, std::size_t ports) {
  int refused = 0;
  const auto expect_refusal = [&](const Request& request) {
    const auto error = refusal_of([&] { client.request(request); });
    EXPECT_TRUE(error.code() == ErrorCode::kBadValue || error.code() == ErrorCode::kWrongState)
        << error.what();
    ++refused;
  };
  for (double bad : kBad) {
    for (std::uint32_t port = 0; port < ports; ++port) expect_refusal(Write{"arm", port, {bad}, 0});
    for (int axis = 0; axis < 3; ++axis) {
      std::vector<double> vector(3, 0.0);
      vector[static_cast<std::size_t>(axis)] = bad;
      expect_refusal(PushBody{"box", vector, {}, {}, 1'000'000});
      expect_refusal(PushBody{"box", {0, 0, 1}, vector, {}, 1'000'000});
      expect_refusal(PushBody{"box", {0, 0, 1}, {}, vector, 1'000'000});
    }
    expect_refusal(SetSpeed{bad});
    for (const auto& parameter : client.request_as<ParameterList>(GetParameters{"arm"}).parameters)
      if (std::holds_alternative<double>(parameter.value))
        expect_refusal(SetParameter{"arm", parameter.name, bad});
  }
  return refused;
}

std::uint64_t run(bool bombarded) {
  RunningDaemon daemon(scene::ClockKind::kLockstep);
  auto client = daemon.connect("client", Role::kAdmin);
  client.request(Join{});
  client.request(AcquireLease{"arm", 0, false});
  client.request(Write{"arm", 0, {0.2}, 0});
  advance(client, 50);
  if (bombarded) {
    EXPECT_GT(bombard(client, describe_arm(client).controller_inputs.size()), 200);
  }
  advance(client, 50);
  return state_hash(client);
}

TEST(BadNumbers, AreRefusedAndLeaveNoTrace) {
  EXPECT_EQ(run(true), run(false));
}

TEST(BadNumbers, MinusZeroAndDenormalsAreNumbersLikeOthers) {
  RunningDaemon daemon(scene::ClockKind::kLockstep);
  auto client = daemon.connect("client");
  client.request(AcquireLease{"arm", 0, false});
  client.request(Write{"arm", 0, {-0.0, std::numeric_limits<double>::denorm_min()}, 0});
}

}  // namespace
}  // namespace visum::gateway
