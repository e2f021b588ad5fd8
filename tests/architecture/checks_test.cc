// Shows that each check finds its fault in a small wrong tree, and finds nothing in a right one.
#include "tests/architecture/checks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <initializer_list>

#include "tests/architecture/rules.h"

namespace visum::architecture {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

struct Text {
  std::string path, text;
};

SourceTree tree_of(std::initializer_list<Text> texts) {
  SourceTree tree;
  for (const Text& file : texts) tree.files.emplace(file.path, make_file(file.path, file.text));
  return tree;
}

std::string lines(std::size_t count, const std::string& line) {
  std::string text;
  for (std::size_t i = 0; i < count; ++i) text += line + "\n";
  return text;
}

TEST(FindsFiles, MissesAFolderWithoutCode) {
  EXPECT_EQ(check_finds_files(SourceTree{}).size(), folders_with_code().size());
  EXPECT_THAT(check_finds_files(tree_of({{"server/world/README.md", ""}})), Not(IsEmpty()));
}

TEST(ReadTree, ThrowsWhereThereIsNoFolder) {
  EXPECT_THROW(read_tree("/nonexistent/visum"), std::filesystem::filesystem_error);
}

TEST(ReadTree, ReadsTextAndLeavesBuildResultsAlone) {
  std::string root = (std::filesystem::temp_directory_path() / "visum-tree-XXXXXX").string();
  ASSERT_NE(mkdtemp(root.data()), nullptr);
  const std::filesystem::path folder(root);
  for (const char* path : {"build/server/a.cc", "server/b.cc", "server/.cache/c.cc", "server/picture.png"}) {
    std::filesystem::create_directories((folder / path).parent_path());
    std::fclose(std::fopen((folder / path).c_str(), "w"));
  }
  const SourceTree tree = read_tree(folder);
  std::filesystem::remove_all(folder);
  EXPECT_THAT(tree.top_level, ElementsAre("build", "server"));
  ASSERT_EQ(tree.files.size(), 1u);
  EXPECT_TRUE(tree.files.contains("server/b.cc"));
}

TEST(TopLevel, RefusesWhatIsNotListed) {
  SourceTree tree;
  tree.top_level = {"README.md", "build", "scripts", "server"};
  EXPECT_THAT(check_top_level(tree), ElementsAre(HasSubstr("scripts")));
}

TEST(IncludesResolve, RefusesARelativeInclude) {
  const auto tree = tree_of({{"server/world/ids.h", ""}, {"server/world/a.cc", "#include \"ids.h\"\n"}});
  EXPECT_THAT(check_includes_resolve(tree), ElementsAre(HasSubstr("server/world/a.cc:1")));
}

struct Arrow {
  const char *from, *to;

  friend void PrintTo(const Arrow& arrow, std::ostream* out) { *out << arrow.from << " -> " << arrow.to; }
};

class RightArrow : public testing::TestWithParam<Arrow> {};
class WrongArrow : public testing::TestWithParam<Arrow> {};

SourceTree tree_of_arrow(const Arrow& arrow) {
  return tree_of({{arrow.from, std::string("#include \"") + arrow.to + "\"\n"}, {arrow.to, ""}});
}

TEST_P(RightArrow, IsAllowed) {
  EXPECT_THAT(check_layers(tree_of_arrow(GetParam())), IsEmpty());
}
TEST_P(WrongArrow, IsFound) {
  EXPECT_THAT(check_layers(tree_of_arrow(GetParam())), ElementsAre(HasSubstr(GetParam().to)));
}

INSTANTIATE_TEST_SUITE_P(Layers, RightArrow,
                         testing::Values(Arrow{"clients/visum/main.cc", "protocol/client.h"},
                                         Arrow{"clients/examples/a.cc", "clients/cpp/visum.h"},
                                         Arrow{"hwparts/part.h", "protocol/part_description.h"},
                                         Arrow{"server/dynamics/engine.h", "hwparts/joint.h"},
                                         Arrow{"server/dynamics/ode/a.cc", "server/dynamics/engine.h"},
                                         Arrow{"server/dynamics/kinds/engine_kinds.cc",
                                               "server/dynamics/ode/a.h"},
                                         Arrow{"server/programs/visumd.cc", "server/gateway/daemon.h"},
                                         Arrow{"tests/cycle/a.cc", "server/cycle/simulation.h"}));
INSTANTIATE_TEST_SUITE_P(Layers, WrongArrow,
                         testing::Values(Arrow{"protocol/server.cc", "hwparts/part.h"},
                                         Arrow{"protocol/config/config.cc", "protocol/limits.h"},
                                         Arrow{"hwparts/drive/drive.cc", "server/world/ids.h"},
                                         Arrow{"hwparts/part.h", "protocol/messages.h"},
                                         Arrow{"server/world/ids.h", "server/collision/collision.h"},
                                         Arrow{"server/world/ids.h", "hwparts/joint.h"},
                                         Arrow{"server/collision/collision.cc", "server/scene/scene.h"},
                                         Arrow{"server/dynamics/engine.h", "hwparts/part.h"},
                                         Arrow{"server/scene/scene.cc", "server/dynamics/engine.h"},
                                         Arrow{"server/cycle/simulation.cc", "server/gateway/gateway.h"},
                                         Arrow{"server/cycle/simulation.cc", "protocol/messages.h"},
                                         Arrow{"server/gateway/gateway.cc", "server/programs/visumd.cc"},
                                         Arrow{"server/gateway/gateway.cc", "clients/cpp/visum.h"},
                                         Arrow{"clients/visum/main.cc", "server/scene/scene.h"},
                                         Arrow{"clients/visum/main.cc", "hwparts/part.h"},
                                         Arrow{"server/programs/visumd.cc", "tests/support/a.h"}));

TEST(Layers, RefusesAFolderThatIsInNoTable) {
  EXPECT_THAT(check_layers(tree_of({{"plugins/a.cc", ""}})), ElementsAre(HasSubstr("plugins/a.cc")));
}

TEST(FolderCycles, FindsTwoFoldersThatIncludeEachOther) {
  const auto tree = tree_of({{"hwparts/drive/a.h", "#include \"hwparts/modules/b.h\"\n"},
                             {"hwparts/drive/c.h", ""},
                             {"hwparts/modules/b.h", ""},
                             {"hwparts/modules/d.cc", "#include \"hwparts/drive/c.h\"\n"}});
  EXPECT_THAT(check_folder_cycles(tree), ElementsAre(HasSubstr("hwparts/drive -> hwparts/modules")));
  EXPECT_THAT(check_file_cycles(tree), IsEmpty());
}

TEST(FolderCycles, FindsThreeFoldersInARing) {
  const auto tree = tree_of({{"hwparts/a/a.h", "#include \"hwparts/b/b.h\"\n"},
                             {"hwparts/b/b.h", "#include \"hwparts/c/c.h\"\n"},
                             {"hwparts/c/c.h", ""},
                             {"hwparts/c/d.h", "#include \"hwparts/a/a.h\"\n"}});
  EXPECT_EQ(check_folder_cycles(tree).size(), 1u);
}

TEST(FileCycles, FindsARing) {
  const auto tree = tree_of({{"server/world/a.h", "#include \"server/world/b.h\"\n"},
                             {"server/world/b.h", "  #  include \"server/world/a.h\"\n"}});
  EXPECT_THAT(check_file_cycles(tree),
              ElementsAre(HasSubstr("server/world/a.h -> server/world/b.h -> server/world/a.h")));
  EXPECT_THAT(check_folder_cycles(tree), IsEmpty());
}

TEST(ThirdParties, AllowsALibraryInTheFolderThatWrapsIt) {
  const auto tree = tree_of({{"server/dynamics/ode/a.cc", "#include <ode/ode.h>\n#include <vector>\n"},
                             {"server/collision/a.cc", "#include <fcl/narrowphase/collision.h>\n"}});
  EXPECT_THAT(check_third_parties(tree), IsEmpty());
}

TEST(ThirdParties, RefusesALibraryElsewhere) {
  const auto tree = tree_of({{"server/cycle/a.cc", "#include <ode/ode.h>\n"},
                             {"server/dynamics/b.cc", "#include <ode/ode.h>\n"},
                             {"server/gateway/c.cc", "#include \"protocol/visum.pb.h\"\n"}});
  EXPECT_THAT(check_third_parties(tree), ElementsAre(HasSubstr("server/cycle/a.cc"), HasSubstr("b.cc"),
                                                     HasSubstr("server/gateway/c.cc")));
}

TEST(ThirdParties, SeesThroughOurHeaders) {
  const auto tree = tree_of({{"server/collision/shapes.h", "#include <fcl/geometry/shape/box.h>\n"},
                             {"server/cycle/a.cc", "#include \"server/collision/shapes.h\"\n"}});
  EXPECT_THAT(check_third_parties(tree), ElementsAre(HasSubstr("(through server/collision/shapes.h)")));
}

TEST(ThirdParties, RefusesALibraryThatNoTableNames) {
  const auto tree = tree_of({{"server/cycle/a.cc", "#include <openssl/ssl.h>\n#include <sys/socket.h>\n"}});
  EXPECT_THAT(check_third_parties(tree), ElementsAre(HasSubstr("openssl/ssl.h")));
}

TEST(PragmaOnce, MissesIt) {
  const auto tree =
      tree_of({{"server/a.h", "// about\n#pragma once\n"}, {"server/b.h", "// #pragma once\n"}});
  EXPECT_THAT(check_pragma_once(tree), ElementsAre(HasSubstr("server/b.h")));
}

TEST(FileLengths, RefusesALongFileOfCode) {
  const auto tree = tree_of({{"server/long.cc", lines(kMaxFileLines + 1, "int;")},
                             {"server/run", lines(kMaxFileLines + 1, "true")},
                             {"server/fits.cc", lines(kMaxFileLines, "int;")},
                             {"models/arm.urdf", lines(kMaxFileLines + 1, "<link/>")}});
  EXPECT_THAT(check_file_lengths(tree), ElementsAre(HasSubstr("server/long.cc"), HasSubstr("server/run")));
}

TEST(FunctionLengths, RefusesALongFunction) {
  const std::string head = "namespace visum {\nstruct A {\n  int b = 1;\n};\n";
  const auto function = [&](std::size_t body) {
    return head + "int A::f(int x) const {\n" + lines(body, "  if (x) { x = '{'; }  // }") + "}\n}\n";
  };
  EXPECT_THAT(check_function_lengths(tree_of({{"server/a.cc", function(kMaxFunctionLines - 1)}})),
              ElementsAre(HasSubstr("server/a.cc:5")));
  EXPECT_THAT(check_function_lengths(tree_of({{"server/a.cc", function(kMaxFunctionLines - 2)}})), IsEmpty());
}

TEST(FunctionLengths, CountsNoClassNoNamespaceAndNoRawString) {
  const auto tree = tree_of({{"server/a.cc", "namespace visum {\nclass A : public B {\n" +
                                                 lines(kMaxFunctionLines + 9, "  int x{1'000};") +
                                                 "};\nvoid f() {\n  g(R\"(}}}} \" { )\");\n}\n}\n"}});
  EXPECT_THAT(check_function_lengths(tree), IsEmpty());
  EXPECT_EQ(find_functions(tree.files.begin()->second).size(), 1u);
}

TEST(UnfinishedWords, FindsEachAsAWordOnly) {
  for (const std::string& word : unfinished_words()) {
    EXPECT_THAT(check_unfinished_words(tree_of({{"docker/Dockerfile", "# ok\n# " + word + ": later\n"}})),
                ElementsAre(HasSubstr("docker/Dockerfile:2")));
    EXPECT_THAT(check_unfinished_words(tree_of({{"server/a.h", "A" + word + "S\n"}})), IsEmpty());
  }
}

TEST(ModelsAreData, RefusesCodeButNotItsGenerators) {
  const auto tree = tree_of({{"models/arm/arm.urdf", ""},
                             {"models/arm/make_inertias.py", ""},
                             {"models/arm/controller.py", ""},
                             {"models/arm/README.md", ""}});
  EXPECT_THAT(check_models_are_data(tree), ElementsAre(HasSubstr("controller.py")));
}

TEST(CommentOpenings, RefusesEachBannedWordInEachLanguage) {
  for (const std::string& word : banned_openings()) {
    const auto tree = tree_of({{"server/a.h", "int x;\n// " + word + " holds it.\n"},
                               {"server/b.cc", "int x;  // " + word + " holds it\n"},
                               {"clients/c.ts", "/** " + word + " holds it. */\n"},
                               {"clients/d.py", "def f():\n    \"\"\"" + word + " holds it.\"\"\"\n"},
                               {"docker/run", "# " + word + " holds it.\n"},
                               {"server/CMakeLists.txt", "# One.\n#\n# " + word + " holds it.\n"}});
    EXPECT_THAT(check_comment_openings(tree),
                ElementsAre(HasSubstr("clients/c.ts:1"), HasSubstr("clients/d.py:2"),
                            HasSubstr("docker/run:1"), HasSubstr("server/CMakeLists.txt:3"),
                            HasSubstr("server/a.h:2"), HasSubstr("server/b.cc:1")));
  }
}

TEST(CommentOpenings, AllowsQuestionsLaterLinesOtherWordsAndText) {
  const auto tree =
      tree_of({{"server/a.h", "// What is there to do when it is\n// full? We wait.\n"},
               {"server/b.h", "// It says to the caller\n// What comes next.\nint x;  // a count\n"},
               {"server/c.h", "int y;  // a count\n        // Which goes on here\n"},
               {"server/d.h", "// Whatever comes, Offsets, Whose\n// Whoever\n"},
               {"server/e.cc", "f(\"// What\"); g('\\'', 1'000);\n"},
               {"clients/f.py", "text = '# What'  # a mark\n"},
               {"README.md", "# What it is\n"}});
  EXPECT_THAT(check_comment_openings(tree), IsEmpty());
}

TEST(CommentWidths, RefusesAWideCommentOnly) {
  const std::string fits(kMaxCommentColumns - 3, 'x');
  const auto tree = tree_of({{"server/a.cc", "// " + fits + "\n// " + fits + "x\n"},
                             {"server/b.cc", "int " + fits + "x;\n"},
                             {"server/c.cc", "f(\"" + fits + " // no comment\");\n"},
                             {"server/d.cc", "// https://" + fits + "\n"},
                             {"clients/e.py", "f(1)  # " + fits + "\n"}});
  EXPECT_THAT(check_comment_widths(tree),
              ElementsAre(HasSubstr("clients/e.py:1"), HasSubstr("server/a.cc:2")));
}

TEST(CommentWidths, CountsCharactersAndNotBytes) {
  std::string text = "//";
  for (std::size_t i = 0; i < kMaxCommentColumns / 2 - 1; ++i) text += " \u03bc";  // 3 bytes, 2 columns
  EXPECT_THAT(check_comment_widths(tree_of({{"server/a.cc", text}})), IsEmpty());
}

TEST(PageWidths, RefusesWideProseOnly) {
  const std::string word(kMaxPageColumns - 2, 'x');
  const auto tree = tree_of({{"a.md", "a " + word + "\nab " + word + "\n"},
                             {"b.md", "```sh\nrun this " + word + "\n```\nrun this " + word + "\n"},
                             {"c.md", "| a | " + word + " |\n<img alt=\"" + word + " x\">\n"},
                             {"d.md", "[a](https://" + word + ") [b](https://" + word + ")\n"},
                             {"e.md", "So:\n\n    code " + word + "\n    code " + word + "\n"},
                             {"f.yaml", "text: a " + word + "\n"}});
  EXPECT_THAT(check_page_widths(tree), ElementsAre(HasSubstr("a.md:2"), HasSubstr("b.md:4")));
}

}  // namespace
}  // namespace visum::architecture
