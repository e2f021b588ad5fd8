// Controllers are found that are known to have exchanged nothing with a part.
#include "clients/visum/run/exchanges.h"

#include <gtest/gtest.h>

namespace visum::run {
namespace {

ControllerSpec controller(const std::string& name, std::vector<std::string> command = {"program"}) {
  ControllerSpec spec;
  spec.name = name;
  spec.client = name + ".py";
  spec.command = std::move(command);
  return spec;
}

protocol::ServerStatus status(std::vector<protocol::Exchange> clients,
                              std::vector<protocol::Exchange> buses = {}) {
  protocol::ServerStatus status;
  status.exchanges = std::move(clients);
  status.bus_exchanges = std::move(buses);
  return status;
}

TEST(Exchanges, AControllerWithoutAnyIsNamed) {
  const std::vector controllers{controller("a"), controller("b")};
  EXPECT_EQ(find_silent_controller(controllers, status({{"a.py", 1}, {"b.py", 7}})), "");
  EXPECT_NE(find_silent_controller(controllers, status({{"a.py", 1}})).find("'b'"), std::string::npos);
  EXPECT_NE(find_silent_controller(controllers, status({{"a.py", 1}, {"b.py", 0}})), "");
  EXPECT_NE(find_silent_controller(controllers, status({})).find("'a'"), std::string::npos);
  EXPECT_EQ(find_silent_controller({}, status({})), "");
}

TEST(Exchanges, OfTheRunnerAreNoControllers) {
  EXPECT_NE(find_silent_controller({controller("a")}, status({{"scenario", 100}})), "");
}

TEST(Exchanges, OfAnUnknownNameAreThoseOfTheOnlyController) {
  EXPECT_EQ(find_silent_controller({controller("a")}, status({{"somebody", 1}})), "");
  EXPECT_EQ(find_silent_controller({controller("a")}, status({}, {{"arm", 1}})), "");
}

TEST(Exchanges, OfAnUnknownNameShowNothingOfOneAmongSeveral) {
  const std::vector controllers{controller("a"), controller("b")};
  const auto why = find_silent_controller(controllers, status({{"a.py", 1}, {"somebody", 1}}));
  EXPECT_NE(why.find("'b' exchanged nothing with a part as client 'b.py'; client 'somebody' did"),
            std::string::npos)
      << why;
  EXPECT_NE(find_silent_controller(controllers, status({{"a.py", 1}}, {{"arm", 1}})).find("the bus of 'arm'"),
            std::string::npos);
  EXPECT_EQ(find_silent_controller(controllers, status({{"a.py", 1}, {"b.py", 1}, {"somebody", 1}})), "");
}

TEST(Exchanges, OfABusAreThoseOfTheControllersThatNameIt) {
  const std::vector controllers{controller("a", {"program", "{bus.arm}"}), controller("b")};
  EXPECT_EQ(find_silent_controller(controllers, status({{"b.py", 1}}, {{"arm", 1}})), "");
  EXPECT_NE(find_silent_controller(controllers, status({}, {{"arm", 1}})).find("'b'"), std::string::npos);
  EXPECT_NE(find_silent_controller(controllers, status({{"b.py", 1}})).find("'a'"), std::string::npos);
}

TEST(Exchanges, OfANameThatSeveralShareShowNothingOfOne) {
  auto twins = std::vector{controller("a"), controller("b")};
  twins[1].client = twins[0].client;
  const auto why = find_silent_controller(twins, status({{"a.py", 2}}));
  EXPECT_NE(why.find("controller 'a' as well as 'b'"), std::string::npos) << why;
  twins[0].exchanges = false;
  EXPECT_EQ(find_silent_controller(twins, status({{"a.py", 2}})), "");

  const std::vector on_one_bus{controller("a", {"program", "{bus.arm}"}),
                               controller("b", {"program", "{bus.arm}"})};
  EXPECT_NE(find_silent_controller(on_one_bus, status({{"a.py", 1}}, {{"arm", 9}})).find("the bus of 'arm'"),
            std::string::npos);
  EXPECT_EQ(find_silent_controller(on_one_bus, status({{"a.py", 1}, {"b.py", 1}}, {{"arm", 9}})), "");
}

TEST(Exchanges, OfTheClientThatAGateNamesBelongToIt) {
  auto gated = controller("a");
  gated.gate = "ports:old-program";
  EXPECT_EQ(find_silent_controller({gated}, status({{"old-program", 1}})), "");
  EXPECT_NE(find_silent_controller({gated, controller("b")}, status({{"old-program", 1}})), "");
}

TEST(Exchanges, AreNotAskedOfOneBehindABridgeOrOneThatIsToHaveNone) {
  auto behind = controller("behind"), log = controller("log");
  behind.through = "bridge";
  log.exchanges = false;
  const std::vector controllers{controller("bridge"), behind, log};
  EXPECT_EQ(find_silent_controller(controllers, status({{"bridge.py", 1}})), "");
  EXPECT_NE(find_silent_controller(controllers, status({})).find("'bridge'"), std::string::npos);
}

}  // namespace
}  // namespace visum::run
