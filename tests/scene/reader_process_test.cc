// A process that reads a file for us may fail, die, hang, or write without end.
#include "server/scene/reader_process.h"

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cerrno>

#include "tests/support/temp_files.h"

namespace visum::scene {
namespace {

using namespace std::chrono_literals;
using test::TempFiles;

class ReaderProcess : public testing::Test {
 protected:
  std::string script(const std::string& lines) const {
    const auto file = files_.write("reader", "#!/bin/sh\n" + lines + "\n");
    std::filesystem::permissions(file, std::filesystem::perms::owner_all);
    return file.string();
  }
  std::string run(const std::string& program, std::chrono::milliseconds deadline = 60s) const {
    return run_reader(program, "what is read\n", {deadline, 4u << 20});
  }
  std::string why_not(const std::string& program, std::chrono::milliseconds deadline = 60s) const {
    try {
      run(program, deadline);
    } catch (const std::runtime_error& error) {
      EXPECT_EQ(::waitpid(-1, nullptr, WNOHANG), -1) << "no child is left";
      EXPECT_EQ(errno, ECHILD);
      return error.what();
    }
    return "";
  }
  TempFiles files_;
};

TEST_F(ReaderProcess, GetsTheFileAndIsHeard) {
  EXPECT_EQ(run(script("cat; echo and more")), "what is read\nand more\n");
}

TEST_F(ReaderProcess, IsGivenNothingElseOfOurs) {
  EXPECT_EQ(run(script("echo $HOME; ls /proc/self/fd | wc -l")), "\n4\n") << "0 to 2, and ls's own";
}

TEST_F(ReaderProcess, ThatFailsGivesItsFirstLineAsTheReason) {
  EXPECT_EQ(why_not(script("echo answer; echo no mesh >&2; echo more >&2; exit 1")), "no mesh");
  EXPECT_EQ(why_not(script("exit 3")), "its reader failed without a reason");
}

TEST_F(ReaderProcess, ThatDiesIsNamedWithItsSignal) {
  EXPECT_EQ(why_not(script("kill -SEGV $$")), "its reader crashed (Segmentation fault)");
}

TEST_F(ReaderProcess, ThatHangsIsKilledAtItsDeadline) {
  EXPECT_EQ(why_not(script("exec sleep 1000"), 50ms), "its reader did not finish within 50 ms");
  EXPECT_EQ(why_not(script("exec >&- 2>&-; exec sleep 1000"), 50ms), "its reader did not finish within 50 ms")
      << "also where it has nothing more to say";
}

TEST_F(ReaderProcess, ThatTalksWithoutEndIsKilled) {
  EXPECT_EQ(why_not(script("exec cat /dev/zero")), "it has more than 4 MiB of triangles");
  EXPECT_EQ(why_not(script("exec cat /dev/zero >&2"), 100ms), "its reader did not finish within 100 ms");
}

TEST_F(ReaderProcess, ThatIsNotThereIsNamed) {
  EXPECT_EQ(why_not("/nowhere/visum-mesh"),
            "its reader, '/nowhere/visum-mesh', cannot be started: No such file or directory");
}

}  // namespace
}  // namespace visum::scene
