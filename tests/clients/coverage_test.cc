#include "clients/visum/run/coverage.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/clients/small_world.h"

namespace visum::run {
namespace {

const std::vector<double> kStanding{0, 0, 0, 1, 0, 0, 0};

protocol::ShapeDescription shape(const std::string& kind, std::vector<double> size,
                                 std::vector<double> pose = kStanding) {
  protocol::ShapeDescription result;
  result.kind = kind;
  result.size = std::move(size);
  result.pose = std::move(pose);
  return result;
}

// 2 m by 1 m in cells of 0.1 m: 200 cells.
FloorSpec floor_spec() {
  FloorSpec spec;
  spec.from = {0, 0};
  spec.to = {2, 1};
  spec.within_m = 0.25;
  return spec;
}

TEST(Coverage, IsNoNumberBeforeTheFirstSample) {
  EXPECT_TRUE(std::isnan(Coverage(floor_spec(), {}).share()));
}

TEST(Coverage, OfAnEmptyFloorIsTheShareOfCellsThatWereNear) {
  Coverage coverage(floor_spec(), {});
  coverage.note(-1, 0.5, {});
  EXPECT_EQ(coverage.share(), 0.0) << "far away";
  coverage.note(0.5, 0.5, {});
  EXPECT_EQ(coverage.share(), 16.0 / 200) << "centres within 0.25 m: a disc of 16 cells";
  coverage.note(0.5, 0.5, {});
  EXPECT_EQ(coverage.share(), 16.0 / 200) << "each cell once";
  for (double x = 0; x <= 2; x += 0.05)
    for (double y = 0; y <= 1; y += 0.05) coverage.note(x, y, {});
  EXPECT_EQ(coverage.share(), 1.0);
}

// Obstacles take away cells: 0.5 x 1 m of a box leave 150; the rest is then all of the floor.
TEST(Coverage, CellsBelowObstaclesDoNotCount) {
  Coverage coverage(floor_spec(), {{0, shape("box", {0.5, 2, 1})}});
  const std::vector<double> poses{1.75, 0.5, 0.5, 1, 0, 0, 0};
  for (double x = 0; x <= 1.5; x += 0.05)
    for (double y = 0; y <= 1; y += 0.05) coverage.note(x, y, poses);
  EXPECT_EQ(coverage.share(), 1.0);
}

// How many of 20,000 cells of 1 cm stay free: one is covered, and the share tells of how many it is one.
double free_cells(const protocol::ShapeDescription& obstacle, const std::vector<double>& poses) {
  FloorSpec spec = floor_spec();
  spec.cell_m = 0.01;
  spec.within_m = 1e-3;
  Coverage coverage(spec, {{0, obstacle}});
  coverage.note(0.105, 0.105, poses);
  return 1.0 / coverage.share();
}

TEST(Coverage, KnowsTheFootprintsOfPlainShapes) {
  const std::vector<double> middle{1, 0.5, 0, 1, 0, 0, 0};
  const double cells = 200 * 100;
  EXPECT_NEAR(free_cells(shape("box", {0.4, 0.2, 1}), middle), cells - 800, 60);
  EXPECT_NEAR(free_cells(shape("cylinder", {0.3, 1}), middle), cells - M_PI * 900, 30);
  EXPECT_NEAR(free_cells(shape("sphere", {0.3}), middle), cells - M_PI * 800, 30) << "at a height of 0.1 m";
  EXPECT_NEAR(free_cells(shape("capsule", {0.3, 1}), middle), cells - M_PI * 900, 30);
  EXPECT_NEAR(free_cells(shape("plane", {}), middle), cells, 1e-6) << "the floor itself";
  EXPECT_NEAR(free_cells(shape("box", {0.4, 0.2, 0.1}), middle), cells, 1e-6) << "lower than the height";
  // A bar of 0.4 by 0.1 m, a body's turn of 30° and a shape's of 60°: it lies across, as long in y.
  const std::vector<double> turned{1, 0.5, 0, std::cos(M_PI / 12), 0, 0, std::sin(M_PI / 12)};
  const auto bar = shape("box", {0.9, 0.1, 1}, {0, 0, 0, std::cos(M_PI / 6), 0, 0, std::sin(M_PI / 6)});
  EXPECT_NEAR(free_cells(bar, turned), cells - 900, 110);
}

TEST(Coverage, AsAQuantityOfAScenario) {
  const auto spec = read_quantity(
      "coverage", config::load_text("{body: box, within: 1, from: [0, 0], to: [4, 4], cell: 1}", "test"));
  Quantity quantity = tie(spec, small_catalogue());
  EXPECT_EQ(quantity.text, "share of the floor within 1 m of box");
  Observation now = small_observation();  // the box at (1, 2)
  EXPECT_EQ(quantity.measure(quantity, now), 4.0 / 16);
  now.world.poses[0] = 3;
  EXPECT_EQ(quantity.measure(quantity, now), 8.0 / 16) << "it remembers";
}

std::string cover_error(const std::string& yaml) {
  try {
    auto catalogue = small_catalogue();
    catalogue.world.bodies[1].fixed = true;
    catalogue.world.bodies[1].shapes = {shape("mesh", {})};
    const auto spec = read_quantity("coverage", config::load_text(yaml, "test"));
    tie(spec, catalogue);
  } catch (const config::ConfigError& error) {
    return error.what();
  }
  return "no error";
}

TEST(Coverage, RefusesAFloorThatIsNone) {
  EXPECT_EQ(cover_error("{body: box, within: 1, from: [0, 0], to: [0, 4]}"),
            "test:1: to: must be greater than 'from' in x and y");
  EXPECT_EQ(cover_error("{body: box, within: 1, from: [0, 0], to: [1000, 1000]}"),
            "test:1: the floor has more than 250000 cells");
  EXPECT_EQ(cover_error("{body: box, within: 0, from: [0, 0], to: [1, 1]}"),
            "test:1: within: must be between 0.001 and 10000, is 0");
  EXPECT_EQ(cover_error("{body: bax, within: 1, from: [0, 0], to: [1, 1]}").substr(0, 8), "test:1: ");
  EXPECT_EQ(
      cover_error("{body: box, within: 1, from: [0, 0], to: [1, 1]}"),
      "test:1: the floor below 'table', which has a mesh, cannot be told; of boxes, spheres, cylinders, "
      "capsules and planes it can");
}

}  // namespace
}  // namespace visum::run
