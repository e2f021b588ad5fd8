// Ports of recordings as CSV.
#include "server/recording/export_csv.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "tests/recording/forge.h"
#include "tests/recording/recorded_world.h"

namespace visum::recording {
namespace {

TEST(ExportCsv, WritesARowPerTickAndAColumnPerPort) {
  RecordedWorld world;
  world->write_inputs(0, 0, std::vector{0.7, -0.3});
  world.run(10);
  const auto file = world.finish();
  std::ostringstream csv;
  const auto result =
      export_csv(file, {{"robot/Desired Angle", "robot/Actual Angle 1"}, 0.003, 0.009, 2}, csv);
  EXPECT_EQ(result.rows, 3u);
  EXPECT_EQ(result.damage, "");
  const auto text = csv.str();
  const std::string head =
      "tick,era,time_s,robot/Desired Angle 1,robot/Desired Angle 2,robot/Actual Angle 1\r\n";
  ASSERT_EQ(text.substr(0, head.size()), head);
  EXPECT_EQ(text.substr(head.size(), 4), "4,1,");
  EXPECT_NE(text.find("0.7,-0.3,"), std::string::npos) << text;
  EXPECT_THROW(export_csv(file, {{"robot/Desired Angel"}}, csv), std::runtime_error);
}

std::string rows_of(const std::filesystem::path& file, const CsvOptions& options) {
  std::ostringstream csv;
  export_csv(file, options, csv);
  const auto text = csv.str();
  return text.substr(text.find('\n') + 1);
}

// 9 ms times 1e-9 is more than 0.009.
TEST(ExportCsv, TimesAreWhatAUserTypesForThem) {
  RecordedWorld world;
  world.run(12);
  const auto file = world.finish();
  for (const double time_s : {0.003, 0.006, 0.007, 0.009, 0.011}) {
    const auto rows = rows_of(file, {{"robot/Desired Angle 1"}, time_s, time_s, 1});
    const auto tick = static_cast<int>(std::lround(time_s * 1000));
    std::ostringstream expected;
    expected << tick << ",1," << time_s << ",";
    EXPECT_EQ(rows.substr(0, expected.str().size()), expected.str());
    EXPECT_EQ(std::ranges::count(rows, '\n'), 1) << rows;
  }
}

// `second` comes after tick 2, goes after tick 4, and comes back after tick 5.
TEST(ExportCsv, PartsThatAreSpawnedHaveCellsWhileTheyAreThere) {
  RecordedWorld world;
  const auto spawn = [&](const std::string& name) {
    return world->spawn({std::filesystem::path(VISUM_SOURCE_DIR) / "models/two_link/two_link.urdf",
                         name,
                         {Eigen::Vector3d(0, 2, 0), Eigen::Quaterniond::Identity()}});
  };
  world.run(2);
  ASSERT_TRUE(spawn("second").done());
  world.run(2);
  ASSERT_TRUE(world->remove_model("second").done());
  world.run(1);
  ASSERT_TRUE(spawn("second").done());
  ASSERT_TRUE(spawn("third").done());
  world.run(1);
  const auto file = world.finish();
  std::ostringstream csv;
  const CsvOptions options{{"robot/Desired Angle 1", "second", "third"}};
  EXPECT_EQ(export_csv(file, options, csv).damage, "");
  std::vector<std::vector<std::string>> rows;
  std::istringstream lines(csv.str());
  for (std::string line; std::getline(lines, line);) {
    line.back() = ',';  // the carriage return
    auto& cells = rows.emplace_back();
    std::istringstream row(line);
    for (std::string cell; std::getline(row, cell, ',');) cells.push_back(cell);
  }
  ASSERT_EQ(rows.size(), 7u);
  const auto is_of = [&](std::size_t column, const std::string& part) {
    return rows[0][column].starts_with(part);
  };
  std::size_t of_second = 0;
  for (std::size_t column = 3; column < rows[0].size(); ++column) {
    of_second += is_of(column, "second/");
    for (std::size_t tick = 1; tick <= 6; ++tick) {
      const bool there = is_of(column, "robot/") ||
                         (is_of(column, "second/") && tick != 1 && tick != 2 && tick != 5) ||
                         (is_of(column, "third/") && tick == 6);
      ASSERT_EQ(rows[tick].size(), rows[0].size());
      EXPECT_EQ(rows[tick][column].empty(), !there) << rows[0][column] << " at tick " << tick;
    }
  }
  EXPECT_GE(of_second, 2u) << "inputs and outputs of two joints";
  EXPECT_THROW(export_csv(file, {{"fourth"}}, csv), std::runtime_error);
}

TEST(ExportCsv, APartWithoutSamplesHasEmptyCells) {
  RecordedWorld world;
  world.run(2);
  const auto forged = world.files().folder() / "forged.mcap";
  forge(
      world.finish(), forged, "", 0, [](auto&) {},
      [](std::string_view topic) { return topic != "/parts/robot"; });
  EXPECT_EQ(rows_of(forged, {{"robot/Desired Angle"}}), "1,1,0.001,,\r\n2,1,0.002,,\r\n");
}

}  // namespace
}  // namespace visum::recording
