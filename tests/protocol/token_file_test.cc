#include "protocol/token_file.h"

#include <gtest/gtest.h>

#include "tests/support/temp_files.h"

namespace visum::protocol {
namespace {

class TokenFile : public ::testing::Test {
 protected:
  std::string written(const std::string& text) const { return files_.write("tokens", text); }
  const test::TempFiles files_;
};

TEST_F(TokenFile, NoFileIsNoToken) {
  EXPECT_EQ(read_token_file("", Role::kAdmin), "");
}

TEST_F(TokenFile, ALineAloneIsTheToken) {
  EXPECT_EQ(read_token_file(written("# mine\n\n  0123456789abcdef  # end\n"), Role::kAdmin),
            "0123456789abcdef");
}

TEST_F(TokenFile, TakesTheLeastRoleThatIsEnough) {
  const std::string file = written("admin AAAA\nobserver OOOO\ncontroller CCCC\n");
  EXPECT_EQ(read_token_file(file, Role::kObserver), "OOOO");
  EXPECT_EQ(read_token_file(file, Role::kController), "CCCC");
  EXPECT_EQ(read_token_file(file, Role::kAdmin), "AAAA");
}

TEST_F(TokenFile, TakesTheGreatestRoleWhereNoneIsEnough) {
  EXPECT_EQ(read_token_file(written("observer OOOO\ncontroller CCCC\n"), Role::kAdmin), "CCCC");
}

TEST_F(TokenFile, PassesOverNamesInCertificates) {
  EXPECT_EQ(read_token_file(written("controller CN=anna\nadmin AAAA\n"), Role::kController), "AAAA");
}

TEST_F(TokenFile, NamesTheFileThatIsWrong) {
  EXPECT_THROW(read_token_file(written("# nothing\n"), Role::kAdmin), std::runtime_error);
  EXPECT_THROW(read_token_file("/nowhere/at/all", Role::kAdmin), std::runtime_error);
}

}  // namespace
}  // namespace visum::protocol
