// visumd, loaded once and started again and again: each process is as new as one that is started in the
// ordinary way, and none outlives those that it belongs to.
#include "clients/visum/run/fork_server.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>

#include "clients/visum/run/daemon.h"

namespace visum::run {
namespace {

using std::chrono::seconds;
using ::testing::HasSubstr;
using ::testing::StartsWith;

const processes::ChildProcess::OnLine kNobody;

// A line of /proc/PID/status: "PPid:\t17" gives 17.
pid_t status_of(pid_t pid, const std::string& name) {
  std::ifstream lines("/proc/" + std::to_string(pid) + "/status");
  for (std::string line; std::getline(lines, line);)
    if (line.starts_with(name + ":")) return std::stoi(line.substr(name.size() + 1));
  return -1;
}

pid_t only_child_of(pid_t parent) {
  pid_t found = -1;
  for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
    const std::string name = entry.path().filename().string();
    if (name.find_first_not_of("0123456789") != name.npos) continue;
    if (status_of(std::stoi(name), "PPid") != parent) continue;
    EXPECT_EQ(found, -1) << "it has two";
    found = std::stoi(name);
  }
  return found;
}

class Forks : public ::testing::Test {
 protected:
  std::unique_ptr<processes::ChildProcess> start(std::vector<std::string> words,
                                                 processes::ChildProcess::OnLine on_out = kNobody) {
    words.insert(words.begin(), (own_folder() / "visumd").string());
    return forks_.start("visumd", words, std::move(on_out), kNobody);
  }
  // A world that runs until it is told to end.
  std::unique_ptr<processes::ChildProcess> start_world() {
    bool ready = false;
    auto world = start({VISUM_SCENES "/two_link.yaml", "--port", "0", "--json", "--http", "off"},
                       [&](const std::string&) { ready = true; });
    for (int i = 0; i < 1000 && !ready; ++i) world->wait_exit(std::chrono::milliseconds(10));
    EXPECT_TRUE(ready);
    return world;
  }

  ForkServer forks_;
};

TEST_F(Forks, EachHasItsOwnWordsOutputAndEnd) {
  for (int i = 0; i < 3; ++i) {
    const auto version = start({"--version"});
    ASSERT_TRUE(version->wait_exit(seconds(60)));
    EXPECT_EQ(version->check_exit()->text(), "exited with code 0");
    ASSERT_EQ(version->last_lines().size(), 1U);
    EXPECT_THAT(version->last_lines()[0], StartsWith("visumd "));
    const auto wrong = start({"no_such.yaml"});
    ASSERT_TRUE(wrong->wait_exit(seconds(60)));
    EXPECT_EQ(wrong->check_exit()->text(), "exited with code 3");
    ASSERT_EQ(wrong->last_lines().size(), 1U);
    EXPECT_THAT(wrong->last_lines()[0], HasSubstr("no_such.yaml"));
  }
}

TEST_F(Forks, ASignalReachesItAndItsEndIsTold) {
  const auto interrupted = start_world();
  interrupted->stop(seconds(60));
  EXPECT_EQ(interrupted->check_exit()->text(), "exited with code 130");
  const auto killed = start_world();
  killed->signal(SIGKILL);
  ASSERT_TRUE(killed->wait_exit(seconds(60)));
  EXPECT_EQ(killed->check_exit()->text(), "was ended by signal 9 (Killed)");
}

// A copy of a process with several threads would have one of them, and the locks of the others.
TEST_F(Forks, TheServerHasOneThreadWhateverItsCopiesHad) {
  start_world()->stop(seconds(60));
  const auto world = start_world();
  const pid_t server = only_child_of(::getpid());
  EXPECT_EQ(status_of(server, "Threads"), 1);
  EXPECT_GT(status_of(only_child_of(server), "Threads"), 1);
}

TEST_F(Forks, ALostServerTakesItsCopyAlongAndIsBegunAnew) {
  const auto world = start_world();
  ::kill(only_child_of(::getpid()), SIGKILL);
  ASSERT_TRUE(world->wait_exit(seconds(60)));
  EXPECT_EQ(world->check_exit()->text(), "was ended by signal 9 (Killed)");
  for (int i = 0; i < 2; ++i) {
    const auto version = start({"--version"});
    ASSERT_TRUE(version->wait_exit(seconds(60)));
    EXPECT_EQ(version->check_exit()->text(), "exited with code 0");
  }
}

TEST_F(Forks, AProgramThatIsNoForkServerIsStartedInTheOrdinaryWay) {
  ForkServer others;
  for (const char* word : {"one", "two"}) {
    const auto echo = others.start("echo", {"/bin/echo", word}, kNobody, kNobody);
    ASSERT_TRUE(echo->wait_exit(seconds(60)));
    EXPECT_THAT(echo->last_lines(), ::testing::ElementsAre(word));
  }
  EXPECT_THROW(others.start("none", {"/no/such/program"}, kNobody, kNobody), std::runtime_error);
}

TEST_F(Forks, WordsThatAreTooManyForItGoTheOrdinaryWay) {
  std::vector<std::string> words{"--version"};
  for (int i = 0; i < 2000; ++i) words.insert(words.end(), {"--bus", std::string(100, 'x')});
  const auto version = start(words);
  ASSERT_TRUE(version->wait_exit(seconds(60)));
  EXPECT_EQ(version->check_exit()->text(), "exited with code 0");
}

}  // namespace
}  // namespace visum::run
