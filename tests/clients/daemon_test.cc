// A daemon that does not do what visumd does: it is wrong, silent, or dies. Small scripts stand in for it,
// since the real one cannot be made to do these things.
#include "clients/visum/run/daemon.h"

#include <gmock/gmock.h>
#include <sys/stat.h>

#include "clients/visum/common/exit_code.h"
#include "tests/support/temp_files.h"

namespace visum::run {
namespace {

using ::testing::HasSubstr;

class DaemonStart : public ::testing::Test {
 protected:
  DaemonOptions options(const std::string& script) {
    const auto program = files_.write("visumd", "#!/bin/sh\n" + script);
    ::chmod(program.c_str(), 0755);
    return {program, "scene.yaml", "lockstep", 0, {}, {}};
  }
  cli::ExitError error_of(const DaemonOptions& options, double patience_s = 10.0) {
    try {
      Daemon daemon(options, patience_s, wait_loop_, [](const std::string&) {});
    } catch (const cli::ExitError& error) {
      return error;
    }
    ADD_FAILURE() << "it was ready";
    return {cli::kDone, ""};
  }

  const test::TempFiles files_;
  WaitLoop wait_loop_{60.0};
};

TEST_F(DaemonStart, ReadsThePortFromTheReadyLine) {
  Daemon daemon(
      options("echo '{\"ready\":true,\"port\":1234,\"scene\":\"s\",\"parts\":[\"arm\"],\"more\":{}}'; sleep "
              "1000"),
      10.0, wait_loop_, [](const std::string&) {});
  EXPECT_EQ(daemon.port(), 1234);
  EXPECT_EQ(daemon.page_port(), 0);
}

TEST_F(DaemonStart, ReadsThePagesPortFromTheReadyLine) {
  Daemon daemon(options("echo '{\"ready\":true,\"port\":1234,\"http\":8080}'; sleep 1000"), 10.0, wait_loop_,
                [](const std::string&) {});
  EXPECT_EQ(daemon.page_port(), 8080);
}

TEST_F(DaemonStart, PassesSceneClockEngineAndSeedOn) {
  DaemonOptions with = options("echo \"$@\" >&2; exit 3");
  with.engine = "ode";
  with.seed = 7;
  const auto error = error_of(with);
  EXPECT_THAT(error.what(),
              HasSubstr("scene.yaml --json -v 1 --clock lockstep --port 0 --http off --engine ode --seed 7"));
  with.serves_page = true;
  EXPECT_THAT(error_of(with).what(), HasSubstr("--port 0 --engine ode --seed 7"));
}

TEST_F(DaemonStart, PassesOnWhatIsWrongWithTheScene) {
  const auto error = error_of(options("echo 'scene.yaml:3: bodies[0]: bad' >&2; exit 3"));
  EXPECT_EQ(error.code(), cli::kBadConfig);
  EXPECT_STREQ(error.what(), "scene.yaml:3: bodies[0]: bad");
}

TEST_F(DaemonStart, TellsThatItDiedBeforeItWasReady) {
  const auto error = error_of(options("echo last words >&2; kill -9 $$"));
  EXPECT_EQ(error.code(), cli::kInvalid);
  EXPECT_STREQ(error.what(), "visumd was ended by signal 9 (Killed) before it was ready\nlast words");
}

TEST_F(DaemonStart, RefusesALineThatIsNoReadyLine) {
  for (const char* line : {"hello", "{\"ready\":false,\"port\":1}", "{\"ready\":true}",
                           "{\"ready\":true,\"port\":70000}", "{\"ready\":true,\"port\":0}"}) {
    const auto error = error_of(options(std::string("echo '") + line + "'; sleep 1000"));
    EXPECT_EQ(error.code(), cli::kInvalid) << line;
    EXPECT_THAT(error.what(), HasSubstr("no ready line")) << line;
  }
}

TEST_F(DaemonStart, DoesNotWaitForEver) {
  const auto error = error_of(options("sleep 1000"), 0.05);
  EXPECT_EQ(error.code(), cli::kInvalid);
  EXPECT_STREQ(error.what(), "visumd is not ready after 0.05 s");
}

TEST_F(DaemonStart, TellsThatItCannotBeStarted) {
  DaemonOptions nowhere = options("");
  nowhere.program = "/nowhere/visumd";
  EXPECT_STREQ(error_of(nowhere).what(), "cannot start '/nowhere/visumd': No such file or directory");
}

TEST_F(DaemonStart, HasAnObituary) {
  Daemon daemon(options("echo '{\"ready\":true,\"port\":1234}'; echo oh >&2; exit 1"), 10.0, wait_loop_,
                [](const std::string&) {});
  ASSERT_TRUE(daemon.process().wait_exit(std::chrono::seconds(10)));
  EXPECT_THAT(daemon.obituary(), HasSubstr("visumd exited with code 1"));
  EXPECT_THAT(daemon.obituary(), HasSubstr("oh"));
}

}  // namespace
}  // namespace visum::run
