// The HTTP port of a real daemon: the page's files, health, metrics, and what it refuses.
#include <gtest/gtest.h>

#include <sstream>

#include "server/gateway/page_files.h"
#include "tests/gateway/http_client.h"
#include "tests/gateway/running_daemon.h"
#include "tests/support/temp_files.h"

namespace visum::gateway {
namespace {

namespace fs = std::filesystem;
using namespace protocol;
using testing::http_get;
using testing::http_request;

constexpr char kScript[] = "/assets/index-0a1b2c3d.js";

// A page as the build leaves one, with a secret beside it, in a folder of its own.
class Page {
 public:
  Page() {
    files_.write("secret.txt", "nobody may read this");
    files_.write("page/index.html", "<!doctype html>");
    files_.write("page" + std::string(kScript), "plain script");
    files_.write("page" + std::string(kScript) + ".gz", "compressed script");
  }
  fs::path folder() const { return files_.folder() / "page"; }
  DaemonOptions served() const {
    DaemonOptions options;
    options.http.on = true;
    options.http.page = folder();
    options.http.port = 0;
    return options;
  }

 private:
  test::TempFiles files_;
};

class WebTest : public ::testing::Test {
 protected:
  std::uint16_t http() const { return daemon_.http_port(); }
  const Page page_;
  RunningDaemon daemon_{scene::ClockKind::kLockstep, page_.served()};
};
using Web = WebTest;

TEST_F(Web, ServesThePage) {
  const auto page = http_get(http(), "/");
  EXPECT_EQ(page.status, 200);
  EXPECT_EQ(page.body, "<!doctype html>");
  EXPECT_EQ(page.fields.at("content-type"), "text/html; charset=utf-8");
  EXPECT_EQ(page.fields.at("cache-control"), "no-cache");
  EXPECT_EQ(http_get(http(), "/index.html").body, page.body);
}

TEST_F(Web, NamesWithAHashMayBeKeptForAYear) {
  const auto script = http_get(http(), kScript);
  EXPECT_EQ(script.body, "plain script");
  EXPECT_EQ(script.fields.at("content-type"), "text/javascript; charset=utf-8");
  EXPECT_EQ(script.fields.at("cache-control"), "public, max-age=31536000, immutable");
}

TEST_F(Web, CompressedBytesGoToThoseWhoTakeThem) {
  const auto script = http_get(http(), kScript, {{"Accept-Encoding", "br, gzip"}});
  EXPECT_EQ(script.body, "compressed script");
  EXPECT_EQ(script.fields.at("content-encoding"), "gzip");
  EXPECT_EQ(script.fields.at("vary"), "Accept-Encoding");
  EXPECT_EQ(http_get(http(), "/", {{"Accept-Encoding", "gzip"}}).fields.count("content-encoding"), 0u);
}

TEST_F(Web, WhatABrowserHasIsNotSentAgain) {
  const auto tag = http_get(http(), "/").fields.at("etag");
  const auto again = http_get(http(), "/", {{"If-None-Match", tag}});
  EXPECT_EQ(again.status, 304);
  EXPECT_EQ(again.body, "");
  EXPECT_EQ(http_get(http(), "/", {{"If-None-Match", "\"other\""}}).status, 200);
}

TEST_F(Web, HeadTellsTheLengthWithoutTheBody) {
  const auto head = http_request(http(), "HEAD", "/");
  EXPECT_EQ(head.status, 200);
  EXPECT_EQ(head.fields.at("content-length"), "15");
  EXPECT_EQ(head.body, "");
}

TEST_F(Web, NothingBesideThePageCanBeNamed) {
  EXPECT_EQ(http_get(http(), "/../secret.txt").status, 400);
  EXPECT_EQ(http_get(http(), "/%2e%2e/secret.txt").status, 404);
  EXPECT_EQ(http_get(http(), "/assets").status, 404);
}

TEST_F(Web, EveryAnswerForbidsFramesSniffingAndOtherOrigins) {
  for (const char* target : {"/", "/healthz", "/metrics", "/nothing"}) {
    const auto fields = http_get(http(), target).fields;
    EXPECT_TRUE(fields.at("content-security-policy").starts_with("default-src 'self';")) << target;
    EXPECT_EQ(fields.at("x-content-type-options"), "nosniff") << target;
    EXPECT_EQ(fields.count("access-control-allow-origin"), 0u) << target;
  }
}

TEST_F(Web, StrangersHostsOriginsAndMethodsAreRefusedAndCounted) {
  EXPECT_EQ(http_get(http(), "/", {{"Host", "rebound.example"}}).status, 421);
  EXPECT_EQ(http_get(http(), "/", {{"Origin", "http://evil.example"}}).status, 403);
  EXPECT_EQ(http_request(http(), "POST", "/").status, 405);
  EXPECT_NE(http_get(http(), "/metrics").body.find("\nvisum_refused_connections_total 3\n"),
            std::string::npos);
}

TEST_F(Web, HealthIsOkWhileTheWorldIs) {
  const auto health = http_get(http(), "/healthz");
  EXPECT_EQ(health.status, 200);
  EXPECT_EQ(health.body, "ok\n");
}

TEST_F(Web, MetricsCountWhatHappened) {
  auto client = daemon_.connect("controller", Role::kController);
  client.request(AcquireLease{"arm"});
  client.request(Join{});
  advance(client, 10);
  refusal_of([&] { client.request(Read{"leg"}); });
  const auto metrics = http_get(http(), "/metrics");
  EXPECT_EQ(metrics.fields.at("content-type"), "text/plain; version=0.0.4; charset=utf-8");
  EXPECT_NE(metrics.body.find("\nvisum_limited_ticks_total 0\n"), std::string::npos);
  for (const char* line : {"visum_ticks 10", "visum_sim_time_seconds 0.01", "visum_sessions 1",
                           "visum_lockstep_members 1", "visum_part_leased{part=\"arm\"} 1",
                           "visum_refused_messages_total 1", "visum_frozen 0", "visum_faults_total 0"})
    EXPECT_NE(metrics.body.find("\n" + std::string(line) + "\n"), std::string::npos) << line << "\n"
                                                                                     << metrics.body;
}

// The text format's own rule: each value belongs to the TYPE line above it.
TEST_F(Web, EveryMetricHasItsHelpAndType) {
  std::istringstream lines(http_get(http(), "/metrics").body);
  std::string last_typed;
  int values = 0;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("# TYPE ")) last_typed = line.substr(7, line.find(' ', 7) - 7);
    if (line.starts_with('#')) continue;
    EXPECT_EQ(line.substr(0, line.find_first_of("{ ")), last_typed);
    ++values;
  }
  EXPECT_GT(values, 20);
}

// With the header of a client that has the token "looking-only-0001".
DaemonOptions guarded(const Page& page, const test::TempFiles& files) {
  auto options = page.served();
  options.token_file = files.write("tokens", "observer looking-only-0001\n");
  fs::permissions(options.token_file, fs::perms::owner_read | fs::perms::owner_write);
  return options;
}

TEST(WebDoor, MetricsAskForTheTokenThatSessionsNeed) {
  const test::TempFiles files;
  const Page page;
  RunningDaemon daemon(scene::ClockKind::kLockstep, guarded(page, files));
  const auto asked_with = [&](const std::string& value) {
    return http_get(daemon.http_port(), "/metrics", {{"Authorization", value}}).status;
  };
  EXPECT_EQ(http_get(daemon.http_port(), "/metrics").status, 401);
  EXPECT_EQ(asked_with("Bearer looking-only-0002"), 401);
  EXPECT_EQ(asked_with("Bearer looking-only-0001"), 200);
  EXPECT_EQ(http_get(daemon.http_port(), "/healthz").status, 200);
}

// Listens on a socket for both kinds of addresses, on which IPv4 addresses look like IPv6 addresses.
TEST(WebDoor, OnAllAddressesEachOfThemIsAName) {
  const test::TempFiles files;
  const Page page;
  auto options = guarded(page, files);
  options.address = "::";
  RunningDaemon daemon(scene::ClockKind::kLockstep, options);
  const auto status = [&](const std::string& address, const std::string& host) {
    const auto port = ":" + std::to_string(daemon.http_port());
    return http_request(daemon.http_port(), "GET", "/", {{"Host", host + port}}, address).status;
  };
  EXPECT_EQ(status("127.0.0.2", "127.0.0.2"), 200);
  EXPECT_EQ(status("127.0.0.2", "127.0.0.3"), 421);
  EXPECT_EQ(status("::1", "[::1]"), 200);
}

TEST(WebDoor, IsShutUnlessAskedFor) {
  EXPECT_EQ(RunningDaemon(scene::ClockKind::kLockstep).http_port(), 0);
}

TEST(WebDoor, APortThatIsTakenIsNamedOrLeft) {
  const Page page;
  RunningDaemon first(scene::ClockKind::kLockstep, page.served());
  auto options = page.served();
  options.http.port = first.http_port();
  try {
    RunningDaemon second(scene::ClockKind::kLockstep, options);
    FAIL() << "two on one port";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find(":" + std::to_string(first.http_port())), std::string::npos)
        << error.what();
  }
  options.http.any_if_taken = true;
  RunningDaemon third(scene::ClockKind::kLockstep, options);
  EXPECT_NE(third.http_port(), first.http_port());
  EXPECT_EQ(http_get(third.http_port(), "/healthz").status, 200);
}

TEST(WebDoor, AFolderThatHoldsNoPageIsNamed) {
  EXPECT_THROW(PageFiles(Page().folder() / "assets"), std::runtime_error);
}

}  // namespace
}  // namespace visum::gateway
