#include "protocol/config/printable.h"

#include <gtest/gtest.h>

namespace visum::config {
namespace {

TEST(Printable, NamesOfAllLanguagesAre) {
  for (const char* name : {"", "arm", "Ärm 1", "рука", "手臂", "ذراع", "🦾", "a\\b", "~"})
    EXPECT_TRUE(is_printable(name)) << name;
}

TEST(Printable, ControlsAreNot) {
  for (unsigned c = 0; c < 0x20; ++c) EXPECT_FALSE(is_printable(std::string(1, static_cast<char>(c)))) << c;
  EXPECT_FALSE(is_printable("\x7f"));
  for (unsigned c = 0x80; c < 0xa0; ++c)
    EXPECT_FALSE(is_printable(std::string("\xc2") + static_cast<char>(c))) << c;
  EXPECT_TRUE(is_printable("\u00a0"));
}

TEST(Printable, NeitherAreSeparatorsNorMarksOfDirection) {
  for (const char* bad : {"\u061c", "\u200e", "\u200f", "\u2028", "\u2029", "\u202a", "\u202b", "\u202c",
                          "\u202d", "\u202e", "\u2066", "\u2067", "\u2068", "\u2069"})
    EXPECT_FALSE(is_printable(std::string("arm") + bad)) << printable(bad);
  for (const char* good : {"\u200d", "\u2027", "\u202f", "\u2065", "\u206a"}) EXPECT_TRUE(is_printable(good));
}

TEST(Printable, NorIsTextThatIsNotUtf8) {
  for (const char* bad :
       {"\xff", "\x9b", "\xc0\xaf", "\xe0\x80\x80", "\xed\xa0\x80", "\xf4\x90\x80\x80", "\xc3"})
    EXPECT_FALSE(is_printable(bad));
}

TEST(Printable, ShowsTheRestEscaped) {
  EXPECT_EQ(printable("anna\nvisumd: error: forged"), "anna\\x0avisumd: error: forged");
  EXPECT_EQ(printable(std::string("a\0b\033[2J", 7)), "a\\x00b\\x1b[2J");
  EXPECT_EQ(printable("\u0085\u009b\u2028\u202e\xff"), "\\u0085\\u009b\\u2028\\u202e\\xff");
  EXPECT_EQ(printable("Ärm\t1\n", "\t"), "Ärm\t1\\x0a");
}

}  // namespace
}  // namespace visum::config
