#include "clients/cpp/token_file.h"

#include <gtest/gtest.h>

#include <fstream>

namespace visum {
namespace {

using protocol::Role;

std::string written(const std::string& text) {
  const std::string file = ::testing::TempDir() + "visum_token_file_test";
  std::ofstream(file, std::ios::trunc) << text;
  return file;
}

TEST(TokenFile, NoFileIsNoToken) {
  EXPECT_EQ(read_token_file("", Role::kAdmin), "");
}

TEST(TokenFile, ALineAloneIsTheToken) {
  EXPECT_EQ(read_token_file(written("# mine\n\n  0123456789abcdef  # end\n"), Role::kAdmin),
            "0123456789abcdef");
}

TEST(TokenFile, TakesTheLeastRoleThatIsEnough) {
  const std::string file = written("admin AAAA\nobserver OOOO\ncontroller CCCC\n");
  EXPECT_EQ(read_token_file(file, Role::kObserver), "OOOO");
  EXPECT_EQ(read_token_file(file, Role::kController), "CCCC");
  EXPECT_EQ(read_token_file(file, Role::kAdmin), "AAAA");
}

TEST(TokenFile, TakesTheGreatestRoleWhereNoneIsEnough) {
  EXPECT_EQ(read_token_file(written("observer OOOO\ncontroller CCCC\n"), Role::kAdmin), "CCCC");
}

TEST(TokenFile, NamesTheFileThatIsWrong) {
  EXPECT_THROW(read_token_file(written("# nothing\n"), Role::kAdmin), std::runtime_error);
  EXPECT_THROW(read_token_file("/nowhere/at/all", Role::kAdmin), std::runtime_error);
}

}  // namespace
}  // namespace visum
