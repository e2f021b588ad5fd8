// A daemon with TLS: which clients get in, with which role, and what the others are told.
#include <gmock/gmock.h>

#include <cstdio>
#include <fstream>
#include <sstream>

#include "tests/gateway/running_daemon.h"
#include "tests/protocol/certificates.h"
#include "tests/support/temp_files.h"

namespace visum::gateway {
namespace {

using namespace protocol;
using std::chrono::seconds;
using ::testing::HasSubstr;
using visum::testing::Certificates;

// The address on which a program listens at `port`, as the kernel writes it.
std::string listening_on(std::uint16_t port) {
  std::ifstream table("/proc/net/tcp");
  char wanted[8];
  std::snprintf(wanted, sizeof wanted, ":%04X", port);
  for (std::string line; std::getline(table, line);) {
    std::istringstream words(line);
    std::string number, local, remote, state;
    words >> number >> local >> remote >> state;
    if (state == "0A" && local.ends_with(wanted)) return local.substr(0, 8);
  }
  return "nobody";
}

class TlsDoors : public ::testing::Test {
 protected:
  DaemonOptions options(const std::string& tokens = {}) {
    DaemonOptions options;
    options.tls = certificates_.files("server");
    if (tokens.empty()) return options;
    const auto file = files_.write("tokens", tokens);
    using std::filesystem::perms;
    std::filesystem::permissions(file, perms::owner_read | perms::owner_write);
    options.token_file = file;
    return options;
  }
  static Connection connect(const RunningDaemon& daemon, const TlsFiles& tls, Role role = Role::kController,
                            const std::string& token = {}) {
    return Connection("127.0.0.1", daemon.port(), {1, 1, "robot", role, token}, seconds(5), tls);
  }

  Certificates certificates_;
  test::TempFiles files_;
};

TEST_F(TlsDoors, ACertificateOpensThemAndEverythingWorksAsInPlainText) {
  for (const auto clock : {scene::ClockKind::kLockstep, scene::ClockKind::kRealtime}) {
    RunningDaemon daemon(clock, options());
    auto client = connect(daemon, certificates_.files("robot"), Role::kAdmin);
    EXPECT_EQ(client.welcome().role, Role::kAdmin);
    const auto arm = describe_arm(client);
    client.request(AcquireLease{"arm"});
    client.request(
        Write{"arm", static_cast<std::uint32_t>(index_of(arm.controller_inputs, "Desired Angle 1")), {0.5}});
    client.request(Pause{});
    client.request(Step{20});
    // One frame that takes many TLS records.
    EXPECT_GT(client.request_as<WorldDescription>(DescribeWorld{}).bodies.size(), 5u);
  }
}

TEST_F(TlsDoors, SubscribedSamplesAllCome) {
  RunningDaemon daemon(scene::ClockKind::kLockstep, options());
  auto client = connect(daemon, certificates_.files("robot"), Role::kAdmin);
  client.request(SubscribeWorld{1});
  client.request(Subscribe{"arm", 1});
  for (int i = 0; i < 50; ++i) {
    client.request(Step{1});
    for (int samples = 0; samples < 2; ++samples) ASSERT_TRUE(client.next(seconds(5)).has_value()) << i;
  }
}

TEST_F(TlsDoors, TheNameInTheCertificateDecidesTheRole) {
  RunningDaemon daemon(
      scene::ClockKind::kLockstep,
      options("observer CN=camera\nadmin CN=the boss # of the lab\ncontroller tokens-work-too-01\n"));
  EXPECT_EQ(connect(daemon, certificates_.files("camera"), Role::kAdmin).welcome().role, Role::kObserver);
  EXPECT_EQ(connect(daemon, certificates_.files("the boss"), Role::kAdmin).welcome().role, Role::kAdmin);
  const auto stranger = certificates_.files("stranger");
  EXPECT_STREQ(refusal_of([&] { connect(daemon, stranger); }).what(),
               "neither a token nor the certificate of 'stranger' gives a role here");
  EXPECT_EQ(connect(daemon, stranger, Role::kAdmin, "tokens-work-too-01").welcome().role, Role::kController);
}

TEST_F(TlsDoors, WhoIsNotAcceptedIsToldWhy) {
  RunningDaemon daemon(scene::ClockKind::kLockstep, options());
  const auto expired = certificates_.files("robot", Certificates::kExpired);
  EXPECT_STREQ(refusal_of([&] { connect(daemon, expired); }).what(),
               "the server ends it: our certificate has expired");
  EXPECT_THAT(refusal_of([&] { connect(daemon, certificates_.self_signed("robot")); }).what(),
              HasSubstr("the server ends it: our certificate is of an authority that it does not know"));
  const Certificates others;
  EXPECT_THAT(refusal_of([&] { connect(daemon, others.files("robot")); }).what(),
              HasSubstr("the server's certificate is not accepted"));
  EXPECT_EQ(connect(daemon, certificates_.files("robot")).welcome().role, Role::kController)
      << "others get in";
}

TEST_F(TlsDoors, PlainTextIsToldThatTlsIsSpoken) {
  RunningDaemon daemon(scene::ClockKind::kLockstep, options());
  const auto refusal = refusal_of([&] { connect(daemon, TlsFiles{}); });
  EXPECT_EQ(refusal.code(), ErrorCode::kUnauthenticated);
  EXPECT_THAT(refusal.what(), HasSubstr("this server speaks TLS only"));
}

TEST_F(TlsDoors, TlsToAPlainServerIsToldSo) {
  RunningDaemon daemon(scene::ClockKind::kLockstep);
  const auto refusal = refusal_of([&] { connect(daemon, certificates_.files("robot")); });
  EXPECT_EQ(refusal.code(), ErrorCode::kUnauthenticated);
  EXPECT_THAT(refusal.what(), HasSubstr("the server does not speak TLS"));
}

TEST_F(TlsDoors, HttpIsServedWhereSessionsAre) {
  auto wanted = options("admin CN=boss\n");
  wanted.address = "0.0.0.0";
  wanted.http.on = true;
  wanted.http.port = 0;
  RunningDaemon daemon(scene::ClockKind::kLockstep, wanted);
  EXPECT_EQ(listening_on(daemon.port()), "00000000");
  EXPECT_EQ(listening_on(daemon.http_port()), "00000000");
}

}  // namespace
}  // namespace visum::gateway
