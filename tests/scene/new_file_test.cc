// Files that replace others once they are complete, with names as long as the file system has them.
#include "protocol/config/new_file.h"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <set>
#include <string>

#include "tests/support/temp_files.h"

namespace visum::config {
namespace {

constexpr std::size_t kLongest = 255;  // bytes of a name, on the file systems of Linux

std::string name_of(std::size_t bytes) {
  return std::string(bytes - 4, 'n') + ".csv";
}

class NewFiles : public ::testing::Test {
 protected:
  std::set<std::string> names() const {
    std::set<std::string> found;
    for (const auto& file : std::filesystem::directory_iterator(files.folder()))
      found.insert(file.path().filename());
    return found;
  }
  const test::TempFiles files;
};

TEST_F(NewFiles, ReplaceOlderOnesOfAnyLengthOfNameOnceTheyAreComplete) {
  for (const std::size_t bytes : {std::size_t{10}, std::size_t{240}, std::size_t{246}, kLongest}) {
    const std::string name = name_of(bytes);
    files.write(name, "older");
    {
      const NewFile made(files.folder() / name);
      ASSERT_TRUE(std::ofstream(made.path()) << "newer") << bytes;
      EXPECT_EQ(files.read(name), "older") << bytes;
      made.keep();
    }
    EXPECT_EQ(files.read(name), "newer") << bytes;
    EXPECT_EQ(names(), std::set<std::string>{name});
    std::filesystem::remove(files.folder() / name);
  }
}

TEST_F(NewFiles, WithLongNamesThatDifferAtTheEndAreNotOne) {
  const std::string same(kLongest - 1, 'n');
  const NewFile a(files.folder() / (same + "a")), b(files.folder() / (same + "b"));
  EXPECT_NE(a.path(), b.path());
}

TEST_F(NewFiles, CutNoCharacterInTwo) {
  std::string name = "x";
  while (name.size() < kLongest) name += "\u00e4";
  for (const std::string& after : {std::string("1"), std::string("12")}) {
    const std::string beside = name_beside(files.folder() / name, after).filename();
    EXPECT_LE(beside.size(), kLongest);
    EXPECT_TRUE(beside.ends_with(after));
    const auto cut = beside.find('~');
    ASSERT_NE(cut, std::string::npos);
    EXPECT_EQ(cut % 2, 1u) << "x, and letters of two bytes";
    EXPECT_EQ(beside.substr(0, cut), name.substr(0, cut));
  }
}

TEST_F(NewFiles, OfALongerNameCannotBeOpened) {
  const NewFile made(files.folder() / name_of(kLongest + 1));
  EXPECT_FALSE(std::ofstream(made.path()));
  EXPECT_EQ(names(), std::set<std::string>{});
}

}  // namespace
}  // namespace visum::config
