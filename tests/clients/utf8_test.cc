#include "clients/visum/common/utf8.h"

#include <gtest/gtest.h>

#include "clients/visum/common/markup.h"
#include "clients/visum/common/terminal.h"

namespace visum::cli {
namespace {

TEST(Utf8, KeepsWhatIsWellFormed) {
  const std::string good = "K\xc3\xbcste \xe2\x82\xac \xf0\x9f\x93\xa6";
  EXPECT_EQ(valid_utf8(good), good);
}

TEST(Utf8, ReplacesEachByteThatIsNot) {
  EXPECT_EQ(valid_utf8("a\xff"), "a?");
  EXPECT_EQ(valid_utf8("\xc0\xaf"), "??") << "overlong";
  EXPECT_EQ(valid_utf8("\xe0\x80\x80"), "???") << "overlong";
  EXPECT_EQ(valid_utf8("\xed\xa0\x80"), "???") << "surrogate";
  EXPECT_EQ(valid_utf8("\xf4\x90\x80\x80"), "????") << "beyond the last code point";
  EXPECT_EQ(valid_utf8("\xc3"), "?") << "cut off";
  EXPECT_EQ(valid_utf8("\xe2\x82"
                       "a"),
            "??a");
}

TEST(Markup, HoldsOnlyWhatXmlAllows) {
  EXPECT_EQ(markup("<a href=\"b\">&\x01\n"), "&lt;a href=&quot;b&quot;&gt;&amp;?&#10;");
  EXPECT_EQ(markup("\xEF\xBF\xBD \xEF\xBF\xBE \xEF\xBF\xBF\xEF\xBF\xBF."), "\xEF\xBF\xBD ? ??.");
}

TEST(Terminal, PrintableTextSteersNothing) {
  EXPECT_EQ(printable("a\033[2Jb\rc\td"), "a\\x1b[2Jb\\x0dc\td");
}

TEST(Terminal, TextIsCutToTheRowsAboveTheCursor) {
  EXPECT_EQ(cut_to_rows("a\nb\nc\n", 4), "a\nb\nc\n");
  EXPECT_EQ(cut_to_rows("a\nb\nc\n", 3), "a\n... 2 more lines\n");
  EXPECT_EQ(cut_to_rows("a\nb\nc\n", 2), "... 3 more lines\n");
  EXPECT_EQ(cut_to_rows("a\nb\nc\n", 0), "a\nb\nc\n") << "a terminal that does not say";
}

TEST(Terminal, StyleWithoutColoursIsTheTextAlone) {
  EXPECT_EQ(Style(false).red("x"), "x");
  EXPECT_EQ(Style(true).red("x"), "\033[31mx\033[0m");
}

}  // namespace
}  // namespace visum::cli
