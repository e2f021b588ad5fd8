// Recordings that are kept only if a run fails.
#include "clients/visum/run/spare_recording.h"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "tests/support/temp_files.h"

namespace visum::run {
namespace {

std::ptrdiff_t files_in(const test::TempFiles& files) {
  return std::distance(std::filesystem::directory_iterator(files.folder()), {});
}

// Keeps a recording that holds `text`, and returns its name.
std::string keep_one(const std::filesystem::path& wanted, const std::string& text) {
  SpareRecording spare(wanted);
  std::ofstream(spare.path()) << text;
  return spare.keep().filename();
}

TEST(SpareRecordings, AreKeptBesideOlderOnesWithNamesOfAnyLength) {
  for (const std::size_t bytes : {10u, 246u, 255u}) {
    const test::TempFiles files;
    const auto wanted = files.folder() / (std::string(bytes - 5, 'n') + ".mcap");
    std::vector<std::string> names;
    for (const std::string text : {"first", "second", "third"}) {
      names.push_back(keep_one(wanted, text));
      EXPECT_EQ(files.read(names.back()), text) << bytes;
      EXPECT_LE(names.back().size(), 255u);
    }
    EXPECT_EQ(names[0], wanted.filename());
    EXPECT_TRUE(names[1].ends_with("_2.mcap")) << names[1];
    EXPECT_TRUE(names[2].ends_with("_3.mcap")) << names[2];
    EXPECT_EQ(files_in(files), 3);
  }
}

TEST(SpareRecordings, LeaveNothingIfTheyAreNotKept) {
  for (const std::size_t bytes : {10u, 255u}) {
    const test::TempFiles files;
    { const SpareRecording spare(files.folder() / std::string(bytes, 'n')); }
    EXPECT_EQ(files_in(files), 0);
  }
}

}  // namespace
}  // namespace visum::run
