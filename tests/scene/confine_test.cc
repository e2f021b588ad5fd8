// Checks what a confined process can still do. Each check runs in a child process, because the child dies of
// it.
#include "server/scene/collada/confine.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <stdexcept>

#include "server/scene/collada/import.h"

namespace visum::collada {
namespace {

class Confined : public testing::Test {
 protected:
  void SetUp() override {
    if (!kForbids) GTEST_SKIP() << "a sanitizer needs memory and calls that are forbidden here";
  }
};

TEST_F(Confined, OpensNoFile) {
  EXPECT_EXIT(
      {
        confine();
        ::open("/etc/hostname", O_RDONLY);
      },
      testing::KilledBySignal(SIGSYS), "");
}

TEST_F(Confined, OpensNoConnection) {
  EXPECT_EXIT(
      {
        confine();
        ::socket(AF_INET, SOCK_STREAM, 0);
      },
      testing::KilledBySignal(SIGSYS), "");
}

TEST_F(Confined, StartsNoProgram) {
  EXPECT_EXIT(
      {
        confine();
        ::execl("/bin/true", "true", nullptr);
      },
      testing::KilledBySignal(SIGSYS), "");
}

TEST_F(Confined, HasBoundedMemory) {
  EXPECT_EXIT(
      {
        confine();
        ::_exit(std::malloc(std::size_t{2} << 30) == nullptr ? 7 : 0);
      },
      testing::ExitedWithCode(7), "");
}

TEST_F(Confined, StillReadsWritesAndThrows) {
  EXPECT_EXIT(
      {
        confine();
        try {
          import_collada("no document");
        } catch (const std::runtime_error&) {
          if (::write(STDERR_FILENO, "refused", 7) == 7) ::_exit(0);
        }
        ::_exit(1);
      },
      testing::ExitedWithCode(0), "refused");
}

}  // namespace
}  // namespace visum::collada
