// The state's hash after a second of the busy scene, for each engine and step setting, and after bodies have
// fallen on each other, for the settings of `impulse`. GCC and Clang, debug and optimised, must give the same
// hash. A hash that changes needs a line in the changelog that says why. The bits are promised for each class
// of processor only, since ODE chooses its code by processor.
#include <map>

#include "tests/dynamics/contract/scenes.h"
#include "tests/dynamics/physics/contact_models.h"

namespace visum::dynamics::testing {
namespace {

using Hashes = std::map<std::string, std::uint64_t>;  // by row

const Hashes kGolden{
    {"OdeWorld", 0x104bf19a5993ab77ull},       {"OdeQuick", 0xcd99abfa3f8f7fe2ull},
    {"Impulse", 0xa15749f988a93b27ull},        {"ImpulseOrder4", 0x2282724ac5a5778eull},
    {"ImpulseIterate", 0x14bd1eaf5e54d5e8ull},
};

void expect_known_hash(const Lab& lab, const Hashes& known, const std::string& row) {
  ASSERT_TRUE(known.contains(row)) << "this engine has no golden hash yet: 0x" << std::hex << lab.hash();
  EXPECT_EQ(lab.hash(), known.at(row)) << std::hex << "now: 0x" << lab.hash();
}

class Golden : public Contract {};
VISUM_INSTANTIATE_CONTRACT(Golden);

TEST_P(Golden, AThousandTicksGiveTheKnownHash) {
  Lab lab(busy_model(GetParam().engine));
  set_busy_drives(lab);
  lab.run_ticks(1000);
  expect_known_hash(lab, kGolden, GetParam().name);
}

// Contacts make a step one of order 2, so the higher orders have the same course and are left out.
std::vector<Row> rows_for_falls() {
  std::vector<Row> found;
  for (const Row& row : rows())
    if (row.engine.name == "impulse" && row.engine.order == 2) found.push_back(row);
  return found;
}

class GoldenFall : public Contract {};
INSTANTIATE_TEST_SUITE_P(Engines, GoldenFall, ::testing::ValuesIn(rows_for_falls()),
                         [](const auto& info) { return info.param.name; });

// Ten boxes that spin fall into a heap, and lie still at the end.
TEST_P(GoldenFall, APileThatComesToRestGivesTheKnownHash) {
  world::WorldModel model = physics::piles(GetParam().engine, 1e-3, 1, 10);
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    const double turn = 2.0 * static_cast<double>(i % 3) - 2.0;
    if (!model.bodies[i].fixed) model.bodies[i].w_WB = {turn, 1.0, 3.0 - turn};
  }
  Lab lab(std::move(model));
  lab.run(2.2);
  EXPECT_LT(lab.kinetic_energy(), 1e-12);
  expect_known_hash(lab, {{"Impulse", 0x2030d3dd6c8aae2aull}, {"ImpulseIterate", 0xf5bf1f0c75ef9e1bull}},
                    GetParam().name);
}

// A ball breaks a wall of 16 bricks: several of its upper ones come to lie on the ground.
TEST_P(GoldenFall, AWallThatFallsGivesTheKnownHash) {
  constexpr double kLying = 0.1, kStarts = 0.2;  // m: height of a brick's centre on the ground, and above it
  ModelBuilder b(GetParam().engine);
  b.model = physics::falling_wall(GetParam().engine, 1e-3, 4);
  b.body(b.add_sphere("ball", 0.15, 5.0, at(0.9, -0.6, 0.6))).v_WB = {1.0, 6.0, 0.0};
  Lab lab(b.model);
  lab.run(1.0);
  int fallen = 0;
  for (std::size_t i = 0; i < lab.model.bodies.size(); ++i)
    fallen += lab.model.bodies[i].X_WB.p.z() > kStarts && lab.state.bodies[i].p_WC.z() < 1.1 * kLying;
  EXPECT_GE(fallen, 4);
  expect_known_hash(lab, {{"Impulse", 0x76b36e6c22ce06bbull}, {"ImpulseIterate", 0x3aa01559e1c2fed6ull}},
                    GetParam().name);
}

}  // namespace
}  // namespace visum::dynamics::testing
