#include "server/gateway/access.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>

#include "protocol/config/config.h"
#include "tests/support/temp_files.h"

namespace visum::gateway {
namespace {

using protocol::Role;

TEST(Access, EveryRequestNeedsTheRoleOfTheTable) {
  using namespace protocol;
  for (const Request& request : std::initializer_list<Request>{
           Status{}, ListParts{}, DescribePart{}, Read{}, Subscribe{}, Unsubscribe{}, GetParameters{},
           ReadBlackboard{}, DescribeWorld{}, ReadWorld{}, SubscribeWorld{}, UnsubscribeWorld{}, ReadMesh{},
           ReadTexture{}, ListFaults{}, ListModels{}, ListScenes{}})
    EXPECT_EQ(role_needed(request), Role::kObserver) << request.index();
  for (const Request& request :
       std::initializer_list<Request>{AcquireLease{}, ReleaseLease{}, Write{}, SetParameter{},
                                      WriteBlackboard{}, Join{}, Advance{}, Leave{}, Note{}})
    EXPECT_EQ(role_needed(request), Role::kController) << request.index();
  for (const Request& request : std::initializer_list<Request>{
           Pause{},        Resume{},          Step{},     SetSpeed{},    Reset{},
           TakeSnapshot{}, RestoreSnapshot{}, PushBody{}, SetBody{},     SetJoints{},
           PullBody{},     ReleaseBody{},     AddBody{},  RemoveBody{},  SpawnModel{},
           RemoveModel{},  LoadScene{},       Shutdown{}, InjectFault{}, ClearFault{}})
    EXPECT_EQ(role_needed(request), Role::kAdmin) << request.index();
}

TEST(Access, AnybodyMayPullAnEmergencyStopAndAControllerReleasesIt) {
  using namespace protocol;
  EXPECT_EQ(role_needed(SetParameter{"arm", "Emergency Stop", true}), Role::kObserver);
  EXPECT_EQ(role_needed(SetParameter{"arm", "Emergency Stop", false}), Role::kController);
  EXPECT_EQ(role_needed(SetParameter{"arm", "Emergency Stop", 1.0}), Role::kController);
  EXPECT_EQ(role_needed(SetParameter{"arm", "Supply Voltage", true}), Role::kController);
}

class TokenFile : public testing::Test {
 protected:
  std::filesystem::path write(const std::string& text) {
    const auto file = files_.write("tokens", text);
    using std::filesystem::perms;
    std::filesystem::permissions(file, perms::owner_read | perms::owner_write);
    return file;
  }
  std::string error_of(const std::string& text) { return error_of_file(write(text)); }
  static std::string error_of_file(const std::filesystem::path& file) {
    try {
      Tokens tokens(file);
    } catch (const config::ConfigError& error) {
      return error.what();
    }
    return "none";
  }
  const test::TempFiles files_;
};

TEST_F(TokenFile, GivesAtMostTheRoleOfItsToken) {
  const Tokens tokens(write("# the lab\nobserver 0123456789abcdef\nadmin    fedcba9876543210\n"));
  EXPECT_EQ(tokens.grant("0123456789abcdef", "", Role::kAdmin), Role::kObserver);
  EXPECT_EQ(tokens.grant("fedcba9876543210", "", Role::kAdmin), Role::kAdmin);
  EXPECT_EQ(tokens.grant("fedcba9876543210", "", Role::kController), Role::kController);
}

TEST_F(TokenFile, LetsNobodyInWithoutAToken) {
  const Tokens tokens(write("admin fedcba9876543210\n"));
  for (const auto* token : {"", "f", "fedcba987654321", "fedcba98765432100", "fedcba9876543211"})
    EXPECT_EQ(tokens.grant(token, "", Role::kObserver), Role::kUnspecified) << token;
}

TEST_F(TokenFile, NamesTheLineThatIsWrong) {
  EXPECT_NE(error_of("admin fedcba9876543210\nboss 0123456789abcdef\n").find(":2: "), std::string::npos);
  EXPECT_NE(error_of("boss 0123456789abcdef\n").find("'boss' is no role"), std::string::npos);
  EXPECT_NE(error_of("admin short\n").find("less than 16"), std::string::npos);
  EXPECT_NE(error_of("admin fedcba9876543210 more\n").find("more than a role and a token"),
            std::string::npos);
  EXPECT_NE(error_of("# nothing\n").find("holds no token"), std::string::npos);
}

TEST_F(TokenFile, MayBeALink) {
  write("admin fedcba9876543210\n");
  const auto link = files_.folder() / "link";
  std::filesystem::create_symlink("tokens", link);
  EXPECT_TRUE(Tokens(link).required());
}

// A pipe that nobody writes to would hang the start.
TEST_F(TokenFile, RefusesWhatIsNoFileWithoutWaiting) {
  const auto pipe = files_.folder() / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_EQ(error_of_file(pipe), pipe.string() + ": is not a regular file");
  EXPECT_EQ(error_of_file(files_.folder()), files_.folder().string() + ": is not a regular file");
  EXPECT_EQ(error_of_file("/dev/null"), "/dev/null: is not a regular file");
  EXPECT_EQ(error_of_file("/nowhere"), "/nowhere: cannot be read: No such file or directory");
}

// Only root can give a file away, so that only root can test it.
TEST_F(TokenFile, RefusesAFileOfAnotherUser) {
  if (::geteuid() != 0) return;
  const auto file = write("admin fedcba9876543210\n");
  ASSERT_EQ(::chown(file.c_str(), 4711, 4711), 0);
  EXPECT_EQ(error_of_file(file), file.string() + ": belongs to another user (id 4711); chown makes it yours");
}

TEST_F(TokenFile, RefusesAFileThatOthersMayRead) {
  const auto file = write("admin fedcba9876543210\n");
  std::filesystem::permissions(file, std::filesystem::perms::others_read, std::filesystem::perm_options::add);
  EXPECT_THROW(Tokens{file}, config::ConfigError);
}

TEST(Access, KnowsLoopback) {
  for (const auto* address : {"127.0.0.1", "127.1.2.3", "::1", "localhost"})
    EXPECT_TRUE(is_loopback(address)) << address;
  for (const auto* address : {"0.0.0.0", "::", "192.168.1.2", "12.7.0.0"})
    EXPECT_FALSE(is_loopback(address)) << address;
}

}  // namespace
}  // namespace visum::gateway
