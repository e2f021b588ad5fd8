// K17 to K22: walls, piles, a house of cards, dominoes, a tippe top.
#include <algorithm>
#include <cmath>

#include "tests/dynamics/physics/case.h"
#include "tests/dynamics/physics/contact_models.h"
#include "tests/dynamics/physics/measures.h"

namespace visum::physics {
namespace {

using dynamics::testing::at;
using dynamics::testing::ModelBuilder;
using Eigen::Vector3d;

// The farthest that any body has come from its start, m.
double farthest(const Lab& lab) {
  double moved = 0.0;
  for (std::size_t i = 0; i < lab.model.bodies.size(); ++i)
    moved = std::max(moved, (lab.state.bodies[i].p_WC - lab.model.bodies[i].X_WB.p).norm());
  return moved;
}

std::vector<double> stand_as_a_wall(const world::EngineSetting& engine, int side, double seconds) {
  Lab lab(standing_wall(engine, 1e-3, side));
  lab.run(seconds);
  return {farthest(lab)};
}

std::vector<double> stand_as_a_small_wall(const world::EngineSetting& engine) {
  return stand_as_a_wall(engine, 5, 1.0);
}

std::vector<double> stand_as_a_large_wall(const world::EngineSetting& engine) {
  return stand_as_a_wall(engine, 10, 5.0);
}

double fastest(const Lab& lab) {
  double speed = 0.0;
  for (const auto& body : lab.state.bodies)
    speed = std::max({speed, body.v_WC.norm(), 0.1 * body.w_WB.norm()});
  return speed;
}

// Boxes that fall into a heap come to rest, and none lies in another.
std::vector<double> settle_as_a_pile(const world::EngineSetting& engine, int boxes, double seconds) {
  Lab lab(piles(engine, 1e-3, 1, boxes));
  lab.run(seconds);
  return {fastest(lab), deepest(lab.contacts)};
}
std::vector<double> settle(const world::EngineSetting& engine) {
  return settle_as_a_pile(engine, 10, 6.0);
}
std::vector<double> settle_as_a_large_pile(const world::EngineSetting& engine) {
  return settle_as_a_pile(engine, 100, 10.0);
}
// Towers are left in it that rock for a long time.
std::vector<double> settle_as_a_huge_pile(const world::EngineSetting& engine) {
  return settle_as_a_pile(engine, 1000, 60.0);
}

// A tall block rocks from edge to edge. With a the angle from its axis to an edge, each landing leaves it
// 1 - 3/2 sin² a of its speed, so it comes to rest.
std::vector<double> stop_rocking(const world::EngineSetting& engine) {
  constexpr double kWide = 0.2, kTall = 1.0, kTurn = 0.3;
  ModelBuilder b(engine);
  const auto surface = b.add_surface(0.8, 0.0);
  b.add_ground(surface);
  const auto block =
      b.add_box("block", {kWide, kWide, kTall}, 5.0, at(0.0, 0.0, 0.5 * kTall - kTouch), surface);
  b.body(block).w_WB = {0.0, kTurn, 0.0};
  b.body(block).v_WB = Vector3d(0.0, kTurn, 0.0).cross(Vector3d(-0.5 * kWide, 0.0, 0.5 * kTall));
  Lab lab(b.model);
  std::vector<double> peaks{0.0};  // of the turn to either side, one after the other
  double sign = 1.0;
  watch(lab, 5.0, [&] {
    const double turn = sign * lab.body("block").w_WB.y();
    if (turn < 0.0) sign = -sign, peaks.push_back(0.0);
    peaks.back() = std::max(peaks.back(), std::abs(turn));
  });
  const double sine = kWide / std::hypot(kWide, kTall), keeps = 1.0 - 1.5 * sine * sine;
  const double landing = peaks.size() > 2 ? std::abs(peaks[2] / peaks[1] / keeps - 1.0) : 1.0;
  return {fastest(lab), landing};
}

// Two pairs of cards that lean on each other, a card that lies on both, and a pair on top of it.
std::vector<double> stand_as_a_house(const world::EngineSetting& engine) {
  constexpr double kLean = 20.0 * kDegree, kLength = 0.2, kHalf = 0.002, kKg = 0.1, kPitch = 0.1;
  ModelBuilder b(engine);
  const auto card = b.add_surface(0.8, 0.0);
  b.add_ground(card);
  const double x = 0.5 * kLength * std::sin(kLean) + kHalf * std::cos(kLean);
  const double z = 0.5 * kLength * std::cos(kLean) + kHalf * std::sin(kLean);
  // The upper edge of a card's outer side is its highest point.
  const double storey = kLength * std::cos(kLean) + 2.0 * kHalf * std::sin(kLean);
  const auto lean = [&](const std::string& name, double middle, double floor) {
    for (const double side : {-1.0, 1.0})
      b.add_box(name + (side < 0.0 ? "_left" : "_right"), {2.0 * kHalf, 0.1, kLength}, kKg,
                at(middle + side * (x - kTouch), 0.0, floor + z - kTouch, -side * kLean, Vector3d::UnitY()),
                card);
  };
  lean("first", -kPitch, 0.0);
  lean("second", kPitch, 0.0);
  b.add_box("lying", {0.4, 0.1, 2.0 * kHalf}, kKg, at(0.0, 0.0, storey + kHalf - 3.0 * kTouch), card);
  lean("top", 0.0, storey + 2.0 * kHalf - 4.0 * kTouch);
  Lab lab(b.model);
  lab.run(5.0);
  return {farthest(lab)};
}

constexpr int kDominoes = 10;
constexpr double kDominoHeight = 0.08, kDominoThick = 0.01, kDominoKg = 0.05;
// Energies are divided by what all of them have where they stand.
constexpr double kStandingEnergy = kDominoes * kDominoKg * kG * 0.5 * kDominoHeight;

// The first domino is pushed over its edge. Each tips the next.
Lab row_of_dominoes(const world::EngineSetting& engine, double pitch) {
  ModelBuilder b(engine);
  const auto surface = b.add_surface(0.5, 0.0);
  b.add_ground(surface);
  for (int i = 0; i < kDominoes; ++i)
    b.add_box("domino_" + std::to_string(i), {kDominoThick, 0.04, kDominoHeight}, kDominoKg,
              at(pitch * i, 0.0, 0.5 * kDominoHeight - kTouch), surface);
  // Enough to lift the centre of mass over the edge, and half as much again.
  const double over = std::hypot(0.5 * kDominoHeight, 0.5 * kDominoThick) - 0.5 * kDominoHeight;
  const double about_edge = kDominoKg * (kDominoHeight * kDominoHeight + kDominoThick * kDominoThick) / 3.0;
  const double turn = std::sqrt(1.5 * 2.0 * kDominoKg * kG * over / about_edge);
  b.model.bodies[1].w_WB = {0.0, turn, 0.0};
  b.model.bodies[1].v_WB =
      Vector3d(0.0, turn, 0.0).cross(Vector3d(-0.5 * kDominoThick, 0.0, 0.5 * kDominoHeight));
  return Lab(b.model);
}

// Where no domino has slid, all but the last lean on the next, face on face, with cos a = thickness / pitch;
// the last lies flat.
double lying_energy(double pitch) {
  const double cosine = kDominoThick / pitch, sine = std::sqrt(1.0 - cosine * cosine);
  const double leaning = 0.5 * (kDominoHeight * cosine + kDominoThick * sine);
  return kDominoKg * kG * ((kDominoes - 1) * leaning + 0.5 * kDominoThick) / kStandingEnergy;
}

struct Dominoes {
  double standing = 0.0;  // how many still stand
  double rise = 0.0;      // of the energy
  double arrival = 0.0;   // s: when the last one has turned by 30°
  double lost = 0.0;      // energy after 0.7 s, while the last one falls
  double rests = 0.0;     // energy at the end
};

// Nothing drives them: energy falls, and rises by no more than it takes to lift what has sunk in.
Dominoes tip_dominoes(const world::EngineSetting& engine, double pitch) {
  constexpr double kLost = 0.7, kEnd = 2.0;  // s
  Lab lab = row_of_dominoes(engine, pitch);
  const auto energy = [&lab] { return energy_of(lab.model, lab.state) / kStandingEnergy; };
  const std::string last = "domino_" + std::to_string(kDominoes - 1);
  Dominoes found{.arrival = kEnd};
  const double start = energy();
  double least = start, time = 0.0;
  watch(lab, kEnd, [&] {
    time += lab.tick_s();
    const double now = energy();
    found.rise = std::max(found.rise, now - least);
    least = std::min(least, now);
    if (std::abs(time - kLost) < 0.5 * lab.tick_s()) found.lost = start - now;
    const double upright = (lab.body(last).q_WB * Vector3d::UnitZ()).z();
    if (upright < std::cos(30.0 * kDegree)) found.arrival = std::min(found.arrival, time);
  });
  found.rests = energy();
  for (int i = 0; i < kDominoes; ++i)
    found.standing += lab.body("domino_" + std::to_string(i)).p_WC.z() > 0.9 * 0.5 * kDominoHeight;
  return found;
}

// Five rows of dominoes that stand some 3 cm apart. The rise depends on when in a tick each domino lands, by
// a factor of up to ten from one pitch to the next, so that the median says more than the largest.
//
// They may lose no more than hits and friction take. The references are `impulse` in ticks of 0.1, 0.05 and
// 0.025 ms, which agree to 0.2 %; `ode` in ticks of 0.05 ms comes to them within 1.1 % (time) and 0.4 %
// (energy). In ticks of 1 ms each of nine hits comes half a tick late in the mean, which is 0.6 % of the
// time.
std::vector<double> fall_as_dominoes(const world::EngineSetting& engine) {
  constexpr double kArrival = 0.7128;  // s, at each of the pitches
  const auto lost_at = [](double pitch) { return 0.2496 + 15.3 * (pitch - 0.03); };
  double standing = 0.0, late = 0.0, lost = 0.0, rests = 0.0;
  std::vector<double> rises;
  for (const double pitch : {0.0298, 0.0299, 0.03, 0.0301, 0.0302}) {
    const Dominoes found = tip_dominoes(engine, pitch);
    standing += found.standing;
    rises.push_back(found.rise);
    late = std::max(late, std::abs(found.arrival / kArrival - 1.0));
    lost = std::max(lost, std::abs(found.lost / lost_at(pitch) - 1.0));
    rests = std::max(rests, std::abs(found.rests - lying_energy(pitch)));
  }
  std::ranges::sort(rises);
  return {standing, rises[2], rises.back(), late, lost, rests};
}

// A ball of 2 cm whose centre of mass lies 3 mm below its centre, spun fast and a little tilted, turns over.
// With d from the centre of mass to the point of contact, Jellett's product L d stays the same, whatever the
// friction is.
std::vector<double> turn_a_tippe_top(const world::EngineSetting& engine) {
  constexpr double kBall = 0.02, kOff = 0.003, kKg = 0.02, kSpin = 150.0, kTilt = 0.1;
  ModelBuilder b(engine);
  const auto surface = b.add_surface(0.3, 0.0);
  b.add_ground(surface);
  const auto top =
      b.add_sphere("top", kBall, kKg, at(0.0, 0.0, kBall - kTouch, kTilt, Vector3d::UnitY()), surface);
  b.body(top).p_BC = {0.0, 0.0, -kOff};
  b.body(top).w_WB = kSpin * Vector3d(std::sin(kTilt), 0.0, std::cos(kTilt));
  Lab lab(b.model);
  const auto up = [&] { return Vector3d(lab.body("top").q_WB * Vector3d::UnitZ()); };
  const auto jellett = [&] {
    const Vector3d d = kOff * up() - kBall * Vector3d::UnitZ();
    return spin_of(lab.model.bodies[top.index()], lab.body("top")).dot(d);
  };
  const double start = jellett();
  double drift = 0.0, lowest = 1.0;
  watch(lab, 4.0, [&] {
    drift = std::max(drift, std::abs(jellett() / start - 1.0));
    lowest = std::min(lowest, up().z());
  });
  return {drift, lowest < -0.9 ? 0.0 : 1.0};
}

}  // namespace

std::vector<Case> standing_cases() {
  const char* still = "closed form: no motion";
  const char* rest = "closed form: what falls loses its energy, and rests without overlap";
  return {
      {"K17", "WallOf5By5BricksStands", still, {{"moved_m", 1e-4}}, stand_as_a_small_wall},
      {"K17l", "WallOf10By10BricksStandsFor5s", still, {{"moved_m", 1e-4}}, stand_as_a_large_wall, true},
      {"K18", "PileOf10Settles", rest, {{"speed_m_per_s", 1e-6}, {"depth_m", 1e-4}}, settle},
      {"K18l",
       "PileOf100Settles",
       rest,
       {{"speed_m_per_s", 1e-6}, {"depth_m", 1e-4}},
       settle_as_a_large_pile,
       true},
      {"K18k",
       "PileOf1000Settles",
       rest,
       {{"speed_m_per_s", 1e-6}, {"depth_m", 1e-4}},
       settle_as_a_huge_pile,
       true},
      {"K19", "HouseOfSevenCardsStands", still, {{"moved_m", 1e-5}}, stand_as_a_house},
      {"K20",
       "DominoesTipEachOther",
       "closed form: all fall, E rises by no more than lifts what has sunk in, and ends as that of leaning "
       "dominoes; ticks of 0.025 ms in between",
       {{"standing", 0.0},
        {"rise", 6e-3},
        {"largest_rise", 6e-3},
        {"arrival", 0.01},
        {"lost_07s", 0.02},
        {"rest_energy", 0.01}},
       fall_as_dominoes},
      {"K21",
       "TippeTopTurnsOver",
       "closed form: Jellett's product is constant (Jellett, A treatise on the theory of friction, 1872)",
       {{"drift", 2.5e-3}, {"stuck", 0.0}},
       turn_a_tippe_top},
      {"K22",
       "RockingBlockComesToRest",
       "closed form: a landing leaves 1 - 3/2 sin² a of the speed (Housner, Bull. Seism. Soc. Am., 1963)",
       {{"speed_m_per_s", 1e-6}, {"landing", 0.02}},
       stop_rocking},
  };
}

}  // namespace visum::physics
