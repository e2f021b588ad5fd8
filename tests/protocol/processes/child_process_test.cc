// Real processes: they print, exit, die, hang, leave children behind. None of it may outlive its
// ChildProcess.
#include "protocol/processes/child_process.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>

namespace visum::processes {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using ::testing::ElementsAre;
using Lines = std::vector<std::string>;

struct Recorder {
  Lines out, err;
  ChildProcess::OnLine on_out() {
    return [this](const std::string& line) { out.push_back(line); };
  }
  ChildProcess::OnLine on_err() {
    return [this](const std::string& line) { err.push_back(line); };
  }
};

Lines shell(const std::string& script) {
  return {"/bin/sh", "-c", script};
}

bool is_alive(pid_t pid) {
  // A zombie is no more alive than nothing; its parent (init) reaps it when it likes.
  const std::string file = "/proc/" + std::to_string(pid) + "/stat";
  char text[256] = {};
  const int fd = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd < 0) return false;
  const auto got = ::read(fd, text, sizeof text - 1);
  ::close(fd);
  const std::string stat(text, got > 0 ? static_cast<std::size_t>(got) : 0);
  const auto end = stat.rfind(") ");
  return end != std::string::npos && stat[end + 2] != 'Z' && stat[end + 2] != 'X';
}

bool dies(pid_t pid) {
  for (int i = 0; i < 1000 && is_alive(pid); ++i)
    ::usleep(10'000);  // bounded: the kernel kills when it gets to it
  return !is_alive(pid);
}

TEST(ChildProcess, HandsOutWholeLinesOfBothOutputs) {
  Recorder recorder;
  ChildProcess child("c", shell("printf 'a\\nb'; echo 1 >&2; printf 'c\\nend'"), recorder.on_out(),
                     recorder.on_err());
  ASSERT_TRUE(child.wait_exit(seconds(10)));
  EXPECT_THAT(recorder.out, ElementsAre("a", "bc", "end"));
  EXPECT_THAT(recorder.err, ElementsAre("1"));
}

TEST(ChildProcess, TellsExitCodeAndSignal) {
  ChildProcess exits("e", shell("exit 3"), {}, {});
  ASSERT_TRUE(exits.wait_exit(seconds(10)));
  EXPECT_EQ(exits.check_exit()->text(), "exited with code 3");
  ChildProcess killed("k", shell("kill -9 $$"), {}, {});
  ASSERT_TRUE(killed.wait_exit(seconds(10)));
  EXPECT_EQ(killed.check_exit()->text(), "was ended by signal 9 (Killed)");
}

TEST(ChildProcess, SaysWhyAProgramCannotBeStarted) {
  try {
    ChildProcess("x", {"/nowhere/program"}, {}, {});
    FAIL() << "it was started";
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "cannot start '/nowhere/program': No such file or directory");
  }
  EXPECT_THROW(ChildProcess("x", {"/etc/passwd"}, {}, {}), std::runtime_error) << "not executable";
}

TEST(ChildProcess, KeepsTheLastLinesOnly) {
  ChildProcess child("c", shell("i=0; while [ $i -lt 100 ]; do echo $i; i=$((i+1)); done"), {}, {});
  ASSERT_TRUE(child.wait_exit(seconds(10)));
  ASSERT_EQ(child.last_lines().size(), ChildProcess::kKeptLines);
  EXPECT_EQ(child.last_lines().back(), "99");
}

TEST(ChildProcess, CutsALineWithoutEnd) {
  ChildProcess child("c", shell("head -c 100000 /dev/zero | tr '\\0' x"), {}, {});
  ASSERT_TRUE(child.wait_exit(seconds(10)));
  ASSERT_EQ(child.last_lines().size(), 1u);
  EXPECT_EQ(child.last_lines().back().size(), ChildProcess::kLongestLine);
}

TEST(ChildProcess, StopsByInterruptWhereThatIsHeard) {
  Recorder recorder;
  ChildProcess child("c", shell("trap 'echo bye; exit 0' INT; echo ready; while :; do sleep 0.01; done"),
                     recorder.on_out(), {});
  while (recorder.out.empty()) child.wait_exit(milliseconds(1));
  child.stop(seconds(10));
  EXPECT_EQ(child.check_exit()->text(), "exited with code 0");
  EXPECT_THAT(recorder.out, ElementsAre("ready", "bye"));
}

TEST(ChildProcess, StopsByForceWhereItIsNot) {
  Recorder recorder;
  ChildProcess child("c", shell("trap '' INT TERM; echo ready; while :; do sleep 0.01; done"),
                     recorder.on_out(), {});
  while (recorder.out.empty()) child.wait_exit(milliseconds(1));
  child.stop(milliseconds(50));
  EXPECT_TRUE(child.check_exit()->by_signal);
  EXPECT_EQ(child.check_exit()->number, SIGKILL);
}

TEST(ChildProcess, LeavesNoGrandchildBehindWhenItEnds) {
  Recorder recorder;
  ChildProcess child("c", shell("sleep 1000 & echo $!"), recorder.on_out(), {});
  ASSERT_TRUE(child.wait_exit(seconds(10)));
  ASSERT_EQ(recorder.out.size(), 1u);
  EXPECT_TRUE(dies(std::atoi(recorder.out[0].c_str())));
}

TEST(ChildProcess, LeavesNothingBehindWhenTheObjectGoes) {
  Recorder recorder;
  {
    ChildProcess child("c", shell("sleep 1000 & echo $!; echo $$; wait"), recorder.on_out(), {});
    while (recorder.out.size() < 2) child.wait_exit(milliseconds(1));
  }
  EXPECT_TRUE(dies(std::atoi(recorder.out[0].c_str())));
  EXPECT_TRUE(dies(std::atoi(recorder.out[1].c_str())));
}

TEST(ChildProcess, DiesWithUsEvenByKill) {
  int pipe_ends[2];
  ASSERT_EQ(::pipe(pipe_ends), 0);
  const pid_t middle = ::fork();
  if (middle == 0) {
    // We are the process that will be killed; its child tells its id through the pipe.
    ChildProcess child("c", shell("echo $$; exec sleep 1000"),
                       [&](const std::string& line) {
                         const pid_t pid = std::atoi(line.c_str());
                         if (::write(pipe_ends[1], &pid, sizeof pid) < 0) ::_exit(1);
                       },
                       {});
    for (;;) child.wait_exit(seconds(1));
  }
  pid_t grandchild = 0;
  ASSERT_EQ(::read(pipe_ends[0], &grandchild, sizeof grandchild), static_cast<ssize_t>(sizeof grandchild));
  ASSERT_TRUE(is_alive(grandchild));
  ::kill(middle, SIGKILL);
  ::waitpid(middle, nullptr, 0);
  EXPECT_TRUE(dies(grandchild));
  ::close(pipe_ends[0]);
  ::close(pipe_ends[1]);
}

TEST(ChildProcess, DoesNotInheritOurFiles) {
  const int fd = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
  Recorder recorder;
  ChildProcess child("c", shell("ls /proc/self/fd | wc -l"), recorder.on_out(), {});
  ASSERT_TRUE(child.wait_exit(seconds(10)));
  ::close(fd);
  EXPECT_EQ(std::atoi(recorder.out.at(0).c_str()), 4) << "0, 1, 2, and the one that ls opened";
}

}  // namespace
}  // namespace visum::processes
