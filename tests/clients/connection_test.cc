// The client library and the runner need of a connection: several requests at once, and a wait with an end.
#include <gtest/gtest.h>

#include "protocol/client.h"
#include "tests/clients/daemon_thread.h"

namespace visum::protocol {
namespace {

using std::chrono::milliseconds;

class ConnectionInLockstep : public ::testing::Test {
 protected:
  Connection connect(const std::string& name) {
    return Connection("127.0.0.1", daemon_.port(), {1, 1, name, Role::kController, {}});
  }
  DaemonThread daemon_{scene::ClockKind::kLockstep};
};

TEST_F(ConnectionInLockstep, RequestsSentTogetherAreAnsweredInTheirOrder) {
  Connection connection = connect("one");
  connection.request(Join{});
  const auto ids = connection.send_together({Advance{5}, Read{"arm"}, Read{"nonsense"}, Status{}});
  ASSERT_EQ(ids.size(), 4u);
  EXPECT_EQ(std::get<ServerStatus>(connection.wait(ids[3])).tick, 5)
      << "in whatever order they are waited for";
  EXPECT_EQ(std::get<PartSample>(connection.wait(ids[1])).tick, 5);
  EXPECT_THROW(connection.wait(ids[2]), RequestError);
  EXPECT_EQ(std::get<Advanced>(connection.wait(ids[0])).tick, 5);
}

TEST_F(ConnectionInLockstep, NothingSentTogetherIsNothing) {
  Connection connection = connect("one");
  EXPECT_TRUE(connection.send_together({}).empty());
  EXPECT_NO_THROW(connection.request(Status{}));
}

TEST_F(ConnectionInLockstep, AWaitWithAnEndCanBeTakenUpAgain) {
  Connection waiting = connect("waiting"), holding = connect("holding");
  holding.request(Join{});
  waiting.request(Join{});
  const auto id = waiting.send(Advance{3});
  EXPECT_FALSE(waiting.wait_for(id, milliseconds(0)).has_value());
  EXPECT_FALSE(waiting.wait_for(id, milliseconds(1)).has_value());
  holding.request(Leave{});
  EXPECT_EQ(std::get<Advanced>(waiting.wait(id)).tick, 3);
}

}  // namespace
}  // namespace visum::protocol
