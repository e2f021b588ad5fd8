#include "protocol/hello.h"

#include <gtest/gtest.h>

#include "protocol/limits.h"

namespace visum::protocol {
namespace {

std::optional<Error> refusal(const Hello& hello) {
  std::uint32_t version = 0;
  return refuse_hello(hello, version);
}

TEST(Hello, VersionIsTheHighestThatBothSpeak) {
  std::uint32_t version = 0;
  EXPECT_FALSE(refuse_hello({1, 99, "x", Role::kObserver, ""}, version));
  EXPECT_EQ(version, kProtocolVersion);
}

TEST(Hello, NoVersionInCommonIsRefusedWithBothRanges) {
  const auto error = refusal({kProtocolVersion + 1, kProtocolVersion + 2, "x", Role::kObserver, ""});
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code, ErrorCode::kVersion);
  EXPECT_EQ(error->text, "this server speaks protocol version 1, the client 2 to 3");
}

TEST(Hello, VersionZeroIsNoVersion) {
  EXPECT_EQ(refusal({0, 0, "x", Role::kObserver, ""})->code, ErrorCode::kVersion);
}

TEST(Hello, MinimumAboveMaximumIsRefused) {
  EXPECT_EQ(refusal({2, 1, "x", Role::kObserver, ""})->code, ErrorCode::kVersion);
}

TEST(Hello, RoleMustBeNamed) {
  EXPECT_EQ(refusal({1, 1, "x", Role::kUnspecified, ""})->code, ErrorCode::kBadValue);
}

TEST(Hello, NamesAreShortAndPrintable) {
  EXPECT_FALSE(refusal({1, 1, std::string(64, 'x'), Role::kObserver, ""}));
  EXPECT_EQ(refusal({1, 1, std::string(65, 'x'), Role::kObserver, ""})->code, ErrorCode::kBadValue);
  for (const char* name :
       {"a\x1b[2Jb", "a\nb", "a\u0085", "\u009b2J", "a\u2028", "a\u202eb", "a\u2066", "\u200f"}) {
    const auto error = refusal({1, 1, name, Role::kObserver, ""});
    ASSERT_TRUE(error);
    EXPECT_EQ(error->code, ErrorCode::kBadValue);
    EXPECT_EQ(error->text,
              "client_name must not hold control characters, separators of lines, or marks of direction");
  }
}

}  // namespace
}  // namespace visum::protocol
