#include "protocol/config/config.h"
#include "protocol/config/unknown_name.h"

#include <gtest/gtest.h>

#include "protocol/config/expression.h"
#include "protocol/config/read_file.h"
#include "protocol/config/trig.h"
#include "tests/support/temp_files.h"

namespace visum::config {
namespace {

Node node(const std::string& yaml) {
  return load_text(yaml, "t.yaml", "folder");
}

template <typename Call>
std::string error_of(const Call& call) {
  static const test::TempFiles files;
  return files.error_of(call);
}

std::string parse_error(const std::string& yaml) {
  return error_of([&] { node(yaml); });
}

std::string repeated(const std::string& text, int times) {
  std::string all;
  for (int i = 0; i < times; ++i) all += text;
  return all;
}

TEST(Config, ReadsEveryKindOfValue) {
  const Node root = node("a: 1.5\nb: -3\nc: true\nd: some text\ne: [1, 2, 3]\nf: {g: '7'}\nh:\n");
  EXPECT_EQ(root.get("a").number(), 1.5);
  EXPECT_EQ(root.get("b").integer(), -3);
  EXPECT_TRUE(root.get("c").boolean());
  EXPECT_EQ(root.get("d").text(), "some text");
  EXPECT_EQ(root.get("e").numbers(3), (std::vector<double>{1, 2, 3}));
  EXPECT_EQ(root.get("f").get("g").text(), "7");
  EXPECT_EQ(root.get("h").kind(), Node::Kind::kNull);
  EXPECT_EQ(root.keys(), (std::vector<std::string>{"a", "b", "c", "d", "e", "f", "h"}));
  EXPECT_FALSE(root.find("z"));
  EXPECT_EQ(root.folder(), "folder");
}

TEST(Config, SumsHaveTheSameBitsOnEveryProcessor) {
  for (int i = -2000; i <= 2000; ++i) {
    const double x = 1e-3 * i;
    const LookUp look_up = [x](const std::string&) { return x; };
    ASSERT_EQ(evaluate("sin(x)", look_up), sin_cos(x).sin) << x;
    ASSERT_EQ(evaluate("cos(x)", look_up), sin_cos(x).cos) << x;
    ASSERT_EQ(evaluate("tan(x)", look_up), sin_cos(x).sin / sin_cos(x).cos) << x;
  }
}

TEST(Config, NumbersAreReadToTheLastBit) {
  EXPECT_EQ(node("1.5707963267948966").number(), 1.5707963267948966);
  EXPECT_EQ(node("+2e-3").number(), 0.002);
  EXPECT_EQ(node("-0.0").number(), 0.0);
  EXPECT_EQ(node("9223372036854775807").integer(), 9223372036854775807);
}

TEST(Config, DefaultsHoldOnlyForMissingKeys) {
  const Node root = node("a: 2\nb: text\nc:\n");
  EXPECT_EQ(root.number_or("x", 7), 7);
  EXPECT_EQ(root.number_or("a", 7), 2);
  EXPECT_EQ(root.text_or("x", "y"), "y");
  EXPECT_TRUE(root.boolean_or("x", true));
  EXPECT_EQ(error_of([&] { root.number_or("c", 7); }), "t.yaml:3: c: must be a number, is empty");
}

TEST(Config, PlacesNameLineAndPath) {
  const Node value = node("a:\n  - b: 1\n  - b: 2\n    c:\n      - 3\n").get("a").at(1).get("c").at(0);
  EXPECT_EQ(value.place().file, "t.yaml");
  EXPECT_EQ(value.place().line, 5);
  EXPECT_EQ(value.place().key, "a[1].c[0]");
}

TEST(Config, NodesKeepTheirDocumentAlive) {
  const Node inner = node("a: {b: [1, 2]}").get("a").get("b");
  EXPECT_EQ(inner.at(1).number(), 2);
}

struct BadValue {
  const char* yaml;
  void (*read)(const Node&);
  const char* message;
};
const BadValue kBadValues[] = {
    {"abc", [](const Node& n) { n.number(); }, "t.yaml:1: must be a number, is 'abc'"},
    {"'5'", [](const Node& n) { n.number(); }, "t.yaml:1: must be a number, is the text '5' in quotes"},
    {"1e999", [](const Node& n) { n.number(); },
     "t.yaml:1: must be a number that a double can hold, is 1e999"},
    {".nan", [](const Node& n) { n.number(); }, "t.yaml:1: must be a finite number, is .nan"},
    {"nan", [](const Node& n) { n.number(); }, "t.yaml:1: must be a finite number, is nan"},
    {"-.inf", [](const Node& n) { n.number(); }, "t.yaml:1: must be a finite number, is -.inf"},
    {"inf", [](const Node& n) { n.number(); }, "t.yaml:1: must be a finite number, is inf"},
    {"0x10", [](const Node& n) { n.number(); }, "t.yaml:1: must be a number, is '0x10'"},
    {"1 2", [](const Node& n) { n.number(); }, "t.yaml:1: must be a number, is '1 2'"},
    {"[1]", [](const Node& n) { n.number(); }, "t.yaml:1: must be a number, is a list"},
    {"{a: 1}", [](const Node& n) { n.number(); }, "t.yaml:1: must be a number, is a map"},
    {"0", [](const Node& n) { n.number(kPositive); }, "t.yaml:1: must be greater than 0, is 0"},
    {"-1e-3", [](const Node& n) { n.number(kNonNegative); }, "t.yaml:1: must be at least 0, is -1e-3"},
    {"1.5",
     [](const Node& n) {
       n.number({0, 1});
     },
     "t.yaml:1: must be between 0 and 1, is 1.5"},
    {"2",
     [](const Node& n) {
       n.number({0, 1, true});
     },
     "t.yaml:1: must be greater than 0 and at most 1, is 2"},
    {"2",
     [](const Node& n) {
       n.number({-std::numeric_limits<double>::max(), 1});
     },
     "t.yaml:1: must be at most 1, is 2"},
    {"1.5", [](const Node& n) { n.integer(); }, "t.yaml:1: must be a whole number, is '1.5'"},
    {"-1", [](const Node& n) { n.integer(0, 9); }, "t.yaml:1: must be a whole number between 0 and 9, is -1"},
    {"9223372036854775808", [](const Node& n) { n.integer(0, 9); },
     "t.yaml:1: must be a whole number between 0 and 9, is 9223372036854775808"},
    {"yes", [](const Node& n) { n.boolean(); }, "t.yaml:1: must be true or false, is 'yes'"},
    {"'true'", [](const Node& n) { n.boolean(); }, "t.yaml:1: must be true or false, is 'true'"},
    {"[a]", [](const Node& n) { n.text(); }, "t.yaml:1: must be a text, is a list"},
    {"~", [](const Node& n) { n.text(); }, "t.yaml:1: must be a text, is empty"},
    {"fre",
     [](const Node& n) {
       n.one_of({"realtime", "free"});
     },
     "t.yaml:1: must be one of realtime, free, is 'fre'; did you mean 'free'?"},
    {"[1, 2]", [](const Node& n) { n.numbers(3); }, "t.yaml:1: must be a list of 3 numbers, has 2"},
    {"[1, x, 3]", [](const Node& n) { n.numbers(3); }, "t.yaml:1: [1]: must be a number, is 'x'"},
    {"5", [](const Node& n) { n.numbers(3); }, "t.yaml:1: must be a list of 3 numbers, is '5'"},
    {"a: 1", [](const Node& n) { n.at(0); }, "t.yaml:1: must be a list, is a map"},
    {"[1]", [](const Node& n) { n.get("a"); }, "t.yaml:1: must be a map, is a list"},
    {"a: 1", [](const Node& n) { n.get("b"); }, "t.yaml:1: key 'b' is missing"},
    {"a: 1\nmasss: 2",
     [](const Node& n) {
       n.allow_only({"a", "mass"});
     },
     "t.yaml:2: unknown key 'masss'; did you mean 'mass'?"},
    {"a: 1\nq: {zzz: 2}", [](const Node& n) { n.get("q").allow_only({"mass"}); },
     "t.yaml:2: q: unknown key 'zzz'"},
};

TEST(Config, RefusesBadValuesByNameAndPlace) {
  for (const BadValue& bad : kBadValues)
    EXPECT_EQ(error_of([&] { bad.read(node(bad.yaml)); }), bad.message) << bad.yaml;
}

TEST(Config, RefusesWhatIsNoPlainTree) {
  EXPECT_EQ(parse_error("a: &x 1"),
            "t.yaml:1: a: anchors and aliases are not supported, write the value out");
  EXPECT_EQ(parse_error("a: &x [1]\nb: *x"),
            "t.yaml:1: a: anchors and aliases are not supported, write the value out");
  EXPECT_EQ(parse_error("a: {<<: {b: 1}}"),
            "t.yaml:1: a: merge keys ('<<') are not supported, write the values out");
  EXPECT_EQ(parse_error("a: !!float 1"), "t.yaml:1: a: tags are not supported ('tag:yaml.org,2002:float')");
  EXPECT_EQ(parse_error("a: 1\nb: {c: 1, c: 2}"), "t.yaml:2: b: key 'c' appears twice, first on line 2");
  EXPECT_EQ(parse_error("a: 1\nb: 2\na: 3"), "t.yaml:3: key 'a' appears twice, first on line 1");
  EXPECT_EQ(parse_error("? [a]\n: 1"), "t.yaml:1: a key must be a plain text");
  EXPECT_EQ(parse_error("a: 1\n---\nb: 2"), "t.yaml: holds more than one YAML document");
  EXPECT_EQ(parse_error("a: [1\nb: 2"), "t.yaml:2: not valid YAML: end of sequence flow not found");
  EXPECT_EQ(parse_error(std::string("a: \x04") + "b"),
            "t.yaml:1: holds a control character (code 4), is this a text file in UTF-8?");
}

TEST(Config, CapsDepthNodesKeysAndLines) {
  EXPECT_EQ(parse_error(repeated("- ", kMaxDepth) + "1"), "no error");
  EXPECT_EQ(parse_error(repeated("- ", kMaxDepth + 1) + "1"), "t.yaml:1: nested deeper than 64 levels");
  EXPECT_EQ(parse_error(repeated("- ", 400'000)), "t.yaml:1: nested deeper than 64 levels");
  EXPECT_EQ(parse_error(repeated("[\n", 100) + repeated("]\n", 100)),
            "t.yaml:65: nested deeper than 64 levels");
  EXPECT_NE(parse_error(repeated("[\n", 400'000)), "no error");
  EXPECT_EQ(parse_error("a: [\n" + repeated("1,\n", kMaxNodes) + "1]"),
            "t.yaml:1000000: a[999998]: more than 1000000 values in one file");
  std::string keys;
  for (int i = 0; i < 10'001; ++i) keys += "k" + std::to_string(i) + ": 1\n";
  EXPECT_EQ(parse_error(keys), "t.yaml:10001: more than 10000 keys in one map");
  const std::string key(251, 'k');
  EXPECT_EQ(parse_error(key + ": 1"), "t.yaml:1: a key has more than 250 bytes");
  EXPECT_EQ(parse_error("? " + key + "\n: 1"), "t.yaml:1: a key has more than 250 bytes");
  EXPECT_EQ(parse_error("a: " + std::string(1u << 20, 'x')), "t.yaml:1: a line has more than 1048576 bytes");
}

std::size_t values_in(const Node& node) {
  std::size_t values = 1;
  if (node.kind() == Node::Kind::kList)
    for (std::size_t i = 0; i < node.size(); ++i) values += values_in(node.at(i));
  if (node.kind() == Node::Kind::kMap)
    for (const auto& key : node.keys()) values += values_in(node.get(key));
  return values;
}

TEST(Config, KnowsWithoutParsingHowManyValuesATextHasAtMost) {
  for (const char* yaml :
       {"1", "", "a: 1", "[]", "[1, -2, [3, 4], {a: 1, b}]", "{a: {b: [1,2,3]}, c: , d: [[[]]]}",
        "a:\n- 1\n-\n  - 2\n  - - 3\n    - 4\n- b: 1\n  c:\n", "- \"a, b: c\"\n- 'd'\n-\t5\n",
        "a: |\n  x\n  y\nb: >\n  z\n", "a:\r\n  - 1\r\n  - 2\r\n"}) {
    EXPECT_GE(most_values(yaml), values_in(node(yaml))) << yaml;
  }
  EXPECT_EQ(most_values("a: -1.5e-3\n"), 2u) << "a sign stands before no value of its own";
}

TEST(Config, BillionLaughsAreRefusedAtTheFirstAnchor) {
  EXPECT_EQ(parse_error("a: &a [x, x]\nb: &b [*a, *a]\nc: &c [*b, *b]\n"),
            "t.yaml:1: a: anchors and aliases are not supported, write the value out");
}

TEST(Config, FilesAreCheckedBeforeTheyAreRead) {
  const test::TempFiles files;
  const auto load = [&](const std::filesystem::path& path) {
    return files.error_of([&] { load_file(path); });
  };
  EXPECT_EQ(load(files.folder() / "none.yaml"), "none.yaml: no such file");
  files.write("dir/x", "");
  EXPECT_EQ(load(files.folder() / "dir"), "dir: is a folder, not a file");
  EXPECT_EQ(load("/dev/zero"), "/dev/zero: is not a regular file");
  const auto huge = files.write("huge.yaml", "a: 1");
  std::filesystem::resize_file(huge, kMaxFileBytes + 1);
  EXPECT_EQ(load(huge), "huge.yaml: has 16777217 bytes, at most 16777216 are read");
  EXPECT_EQ(load_file(files.write("good.yaml", "a: 1")).folder(), files.folder());
}

TEST(Config, SurvivesTextsOfRandomBytes) {
  const std::string seeds = "a: [1, {b: c}]\n- &x *y !z 'q' \"w\\n\" | > ? : # % @ ` <<: ---\n...\t{}";
  std::uint32_t random = 1;
  for (int round = 0; round < 3000; ++round) {
    std::string text;
    for (int i = 0; i < 60; ++i) {
      random = random * 1664525u + 1013904223u;
      text += seeds[(random >> 16) % seeds.size()];
    }
    EXPECT_NO_FATAL_FAILURE(parse_error(text)) << text;
  }
}

TEST(Config, NearestFindsSlipsAndNothingElse) {
  const std::vector<std::string> words = {"mass", "radius", "length"};
  EXPECT_EQ(nearest("masss", words), "mass");
  EXPECT_EQ(nearest("lenght", words), "length");
  EXPECT_EQ(nearest("colour", words), std::nullopt);
  EXPECT_EQ(nearest(std::string(1000, 'm'), words), std::nullopt);
}

TEST(Config, UnknownNamesAreToldWithTheNearestOrWithAShortList) {
  EXPECT_EQ(unknown_name("key", "masss", {"mass", "radius"}),
            "there is no key 'masss'; did you mean 'mass'?");
  EXPECT_EQ(unknown_name("key", "colour", {"mass", "radius"}),
            "there is no key 'colour'; there are: mass, radius");
  EXPECT_EQ(unknown_name("key", "colour", {"mass"}), "there is no key 'colour'; there is only 'mass'");
  EXPECT_EQ(unknown_name("key", "colour", {}), "there is no key 'colour'");
  EXPECT_EQ(unknown_name("key", "colour", std::vector<std::string>(9, "mass")), "there is no key 'colour'");
}

TEST(ReadFile, OneFileHasOneIdentity) {
  const test::TempFiles files;
  const auto file = files.write("real/a.yaml", ""), link = files.folder() / "link";
  std::filesystem::create_directory_symlink("real", link);
  EXPECT_EQ(identity_of(link / "a.yaml"), identity_of(file));
  EXPECT_EQ(identity_of(files.folder() / "real/../real/./a.yaml"), identity_of(file));
  EXPECT_TRUE(identity_of("nowhere.yaml").is_absolute());
  // The disk does not tell where this leads. Two files behind it are two files all the same.
  const auto loop = files.folder() / "loop";
  std::filesystem::create_symlink("loop", loop);
  EXPECT_EQ(identity_of(loop / "a.yaml"), loop / "a.yaml");
  const Files all;
  const FilesGiven given(all);
  EXPECT_EQ(identity_of(link / "a.yaml"), link / "a.yaml") << "the disk is not asked";
}

}  // namespace
}  // namespace visum::config
