// Errors of the client library carry the code, the part, the port and the text.
#include <gmock/gmock.h>

#include <limits>
#include <optional>
#include <thread>

#include "clients/cpp/visum.h"
#include "tests/clients/daemon_thread.h"

namespace visum {
namespace {

using scene::ClockKind;
using ::testing::HasSubstr;

template <typename Action>
Error error_of(Action action) {
  try {
    action();
  } catch (const Error& error) {
    return error;
  }
  ADD_FAILURE() << "nothing was thrown";
  return Error(ErrorCode::kUnspecified, "");
}

class ClientErrors : public ::testing::Test {
 protected:
  ClientErrors() : daemon_(std::in_place, ClockKind::kLockstep) {}
  std::string address() const { return daemon_->address(); }
  std::optional<DaemonThread> daemon_;
  Client client_{address(), {.name = "tester"}};
};

TEST_F(ClientErrors, NamesTheNearestPart) {
  const Error error = error_of([&] { client_.part("amr"); });
  EXPECT_EQ(error.code(), ErrorCode::kUnknownName);
  EXPECT_EQ(error.part(), "amr");
  EXPECT_STREQ(error.what(), "there is no part 'amr'; did you mean 'arm'?");
}

TEST_F(ClientErrors, NamesTheNearestPort) {
  const Part arm = client_.part("arm");
  const Error error = error_of([&] { arm.output("Actual Angel 1"); });
  EXPECT_EQ(error.code(), ErrorCode::kUnknownName);
  EXPECT_EQ(error.port(), "Actual Angel 1");
  EXPECT_STREQ(error.what(),
               "part 'arm' has no sensor output 'Actual Angel 1'; did you mean 'Actual Angle 1'?");
  EXPECT_THAT(error_of([&] { arm.inputs("Desired Angel"); }).what(), HasSubstr("'Desired Angle'"));
  EXPECT_EQ(error_of([&] { arm.input(1000); }).code(), ErrorCode::kUnknownName);
  EXPECT_EQ(error_of([&] { arm.parameter("nonsense"); }).code(), ErrorCode::kUnknownName);
}

TEST_F(ClientErrors, RefusesABadValueBeforeItIsSent) {
  Part arm = client_.part("arm");
  Inputs desired = arm.inputs("Desired Angle");
  const double before = desired[1];
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e308, -1e308}) {
    const Error error = error_of([&] { desired.set({0.0, bad, 0.0, 0.0, 0.0, 0.0, 0.0}); });
    EXPECT_EQ(error.code(), ErrorCode::kBadValue);
    EXPECT_EQ(error.part(), "arm");
    EXPECT_EQ(error.port(), "Desired Angle 2");
    EXPECT_THAT(error.what(), HasSubstr("rad"));
  }
  EXPECT_EQ(desired[1], before) << "all or nothing";
}

TEST_F(ClientErrors, RefusesVectorsOfTheWrongLength) {
  Part arm = client_.part("arm");
  Inputs desired = arm.inputs("Desired Angle");
  EXPECT_EQ(error_of([&] { desired.set({1.0, 2.0}); }).code(), ErrorCode::kMisuse);
  EXPECT_EQ(error_of([&] { desired.set(7, 0.0); }).code(), ErrorCode::kMisuse);
  EXPECT_EQ(error_of([&] { desired.set(0.0); }).code(), ErrorCode::kMisuse);
  EXPECT_EQ(error_of([&] { static_cast<void>(desired[7]); }).code(), ErrorCode::kMisuse);
}

TEST_F(ClientErrors, TellsWhoHoldsTheLease) {
  Client other(address(), {.name = "the other one"});
  Part theirs = other.part("arm");
  theirs.acquire();
  Part mine = client_.part("arm");
  const Error error = error_of([&] { mine.acquire(); });
  EXPECT_EQ(error.code(), ErrorCode::kLeased);
  EXPECT_EQ(error.owner(), "the other one");
  EXPECT_FALSE(mine.leased());
}

TEST_F(ClientErrors, ThrowsTheRefusalOfAPostedWriteAtTheNextAdvance) {
  Part arm = client_.part("arm");
  client_.join();
  arm.input("Desired Angle 1").set(0.1);
  EXPECT_NO_THROW(arm.write()) << "posted: nobody has answered yet";
  const Error error = error_of([&] { client_.advance_ms(10); });
  EXPECT_EQ(error.code(), ErrorCode::kNoLease);
  EXPECT_EQ(error.part(), "arm");
  EXPECT_EQ(client_.tick(), 10) << "the period has passed all the same";
  EXPECT_NO_THROW(client_.advance_ms(10)) << "thrown once";
}

TEST_F(ClientErrors, ThrowsTheRefusalOfAPostedWriteAtTheNextRead) {
  Part arm = client_.part("arm");
  arm.input("Desired Angle 1").set(0.1);
  arm.write();
  EXPECT_EQ(error_of([&] { arm.read(); }).code(), ErrorCode::kNoLease);
}

TEST_F(ClientErrors, SurvivesManyWritesThatNobodyLooksAt) {
  Part arm = client_.part("arm");
  arm.acquire();
  client_.join();
  const Inputs angles = arm.inputs("Desired Angle");
  for (int i = 0; i < 200; ++i) arm.input("Desired Angle 1").set(angles[0]), arm.write();
  EXPECT_NO_THROW(client_.advance_ms(1));
  EXPECT_NO_THROW(arm.release());
}

TEST_F(ClientErrors, RefusesToAdvanceWithoutJoining) {
  EXPECT_EQ(error_of([&] { client_.advance_ms(10); }).code(), ErrorCode::kWrongState);
  EXPECT_EQ(error_of([&] { client_.advance_ms(-1); }).code(), ErrorCode::kMisuse);
  EXPECT_EQ(error_of([&] { client_.advance_ms(std::numeric_limits<double>::quiet_NaN()); }).code(),
            ErrorCode::kMisuse);
  EXPECT_EQ(error_of([&] { client_.advance_ticks(0); }).code(), ErrorCode::kMisuse);
}

TEST_F(ClientErrors, TellsThatItWasTooSlowForTheLockstep) {
  Client other(address(), {.name = "other"});
  client_.join(std::chrono::milliseconds(1));
  other.join();
  EXPECT_EQ(error_of([&] { other.advance_ms(10); }).code(), ErrorCode::kTimeout);
  const Error error = error_of([&] { client_.advance_ms(10); });
  EXPECT_EQ(error.code(), ErrorCode::kTimeout);
  EXPECT_THAT(error.what(), HasSubstr("'tester' held the lockstep at tick 0"));
}

TEST_F(ClientErrors, RefusesARoleThatMayNot) {
  Client observer(address(), {.name = "observer", .role = Role::kObserver});
  Part arm = observer.part("arm");
  EXPECT_EQ(error_of([&] { arm.acquire(); }).code(), ErrorCode::kForbidden);
}

TEST_F(ClientErrors, TellsThatTheServerIsGone) {
  Part arm = client_.part("arm");
  arm.acquire();
  client_.join();
  daemon_.reset();
  EXPECT_EQ(error_of([&] {
              for (;;) client_.advance_ms(10);
            }).code(),
            ErrorCode::kConnection);
}

TEST_F(ClientErrors, TellsAPartThatItsClientIsGone) {
  std::optional<Client> client(std::in_place, address(), ClientOptions{.name = "short-lived"});
  Part arm = client->part("arm");
  client.reset();
  EXPECT_EQ(error_of([&] { arm.read(); }).code(), ErrorCode::kConnection);
}

TEST(ClientConnect, RefusesAnAddressThatIsNone) {
  EXPECT_EQ(error_of([] { Client("here:there"); }).code(), ErrorCode::kMisuse);
}

TEST(ClientConnect, GivesUpAtOnceWithoutPatience) {
  // A port that was free a moment ago, on which nobody listens any more.
  const std::string address = DaemonThread(ClockKind::kLockstep).address();
  const Error error =
      error_of([&] { Client(address, {.name = "hasty", .connect_timeout = std::chrono::milliseconds(0)}); });
  EXPECT_EQ(error.code(), ErrorCode::kConnection);
  EXPECT_THAT(error.what(), HasSubstr("nothing listens at " + address));
}

TEST(ClientConnect, WaitsForAServerThatIsStarting) {
  const std::uint16_t port = DaemonThread(ClockKind::kLockstep).port();
  std::optional<Client> client;
  std::thread patient(
      [&] { client.emplace("127.0.0.1:" + std::to_string(port), ClientOptions{.name = "patient"}); });
  DaemonThread daemon(ClockKind::kLockstep, 1.0, port);
  patient.join();
  ASSERT_TRUE(client.has_value());
  EXPECT_EQ(client->server().clock, "lockstep");
}

}  // namespace
}  // namespace visum
