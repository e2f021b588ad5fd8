// Holds the real source tree to every rule. checks_test.cc shows that each rule can fail.
#include <gtest/gtest.h>

#include "tests/architecture/checks.h"

namespace visum::architecture {
namespace {

const SourceTree& real_tree() {
  static const SourceTree tree = read_tree(VISUM_SOURCE_DIR);
  return tree;
}

void expect_none(const Findings& found) {
  std::string list;
  for (const std::string& finding : found) list += "\n" + finding;
  if (!found.empty()) ADD_FAILURE() << found.size() << " findings:" << list;
}

TEST(Architecture, FindsTheFilesThatItIsToRead) {
  expect_none(check_finds_files(real_tree()));
}
TEST(Architecture, TopLevelHoldsWhatIsListed) {
  expect_none(check_top_level(real_tree()));
}
TEST(Architecture, EveryQuotedIncludeIsAFile) {
  expect_none(check_includes_resolve(real_tree()));
}
TEST(Architecture, IncludesFollowTheArrows) {
  expect_none(check_layers(real_tree()));
}
TEST(Architecture, NoFoldersIncludeEachOther) {
  expect_none(check_folder_cycles(real_tree()));
}
TEST(Architecture, NoFilesIncludeEachOther) {
  expect_none(check_file_cycles(real_tree()));
}
TEST(Architecture, WrappedLibrariesStayInTheirFolder) {
  expect_none(check_third_parties(real_tree()));
}
TEST(Architecture, HeadersAreReadOnce) {
  expect_none(check_pragma_once(real_tree()));
}
TEST(Architecture, FilesAreShort) {
  expect_none(check_file_lengths(real_tree()));
}
TEST(Architecture, FunctionsAreShort) {
  expect_none(check_function_lengths(real_tree()));
}
TEST(Architecture, NothingIsLeftUnfinished) {
  expect_none(check_unfinished_words(real_tree()));
}
TEST(Architecture, ModelsAreData) {
  expect_none(check_models_are_data(real_tree()));
}
TEST(Architecture, CommentsBeginAsSentencesDo) {
  expect_none(check_comment_openings(real_tree()));
}
TEST(Architecture, CommentsFitTheScreen) {
  expect_none(check_comment_widths(real_tree()));
}
TEST(Architecture, PagesFitTheScreen) {
  expect_none(check_page_widths(real_tree()));
}

}  // namespace
}  // namespace visum::architecture
