#include "clients/examples/explorer/floor_map.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace visum::explorer {
namespace {

// The evidence that a ray adds to the cell at its end and to the cells on its path, and the limits of a
// cell's evidence.
constexpr int kHit = 6, kPass = -1, kLeast = -10, kMost = 60, kSomething = 6;
constexpr double kKeepOff_m = 0.32;
constexpr int kWorthwhile = 6;  // cells that are not covered yet
constexpr std::uint16_t kNoWay = std::numeric_limits<std::uint16_t>::max();
constexpr std::array<std::array<int, 2>, 4> kNeighbours{{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};

}  // namespace

FloorMap::FloorMap(double near_m) : near_(disc(near_m)), keep_off_(disc(kKeepOff_m)) {
  reset();
}

void FloorMap::reset() {
  evidence_.assign(kSide * kSide, 0);
  done_.assign(kSide * kSide, 0);
  blocked_.assign(kSide * kSide, 0);
  steps_.assign(kSide * kSide, kNoWay);
}

std::array<int, 2> FloorMap::cell(double x, double y) {
  const auto index = [](double m) {
    return static_cast<int>(std::floor(std::clamp(m / kCell_m, -1e6, 1e6))) + kSide / 2;
  };
  return {index(x), index(y)};
}

FloorMap::Disc FloorMap::disc(double radius_m) {
  Disc cells;
  const int reach = static_cast<int>(radius_m / kCell_m);
  for (int i = -reach; i <= reach; ++i)
    for (int j = -reach; j <= reach; ++j)
      if (std::hypot(i, j) * kCell_m <= radius_m) cells.push_back({i, j});
  return cells;
}

void FloorMap::see(double x, double y, double direction, double distance_m, bool met) {
  const double cos = std::cos(direction), sin = std::sin(direction);
  const auto end = cell(x + distance_m * cos, y + distance_m * sin);
  std::array<int, 2> last{-1, -1};
  for (double way = 0.0; way < distance_m; way += kCell_m / 2) {
    const auto here = cell(x + way * cos, y + way * sin);
    if (here == last || here == end || !inside(here[0], here[1])) continue;
    auto& evidence = evidence_[at(here[0], here[1])];
    evidence = static_cast<std::int8_t>(std::max(kLeast, evidence + kPass));
    last = here;
  }
  if (!met || !inside(end[0], end[1])) return;
  auto& evidence = evidence_[at(end[0], end[1])];
  evidence = static_cast<std::int8_t>(std::min(kMost, evidence + kHit));
}

void FloorMap::cover(double x, double y) {
  const auto [ci, cj] = cell(x, y);
  for (const auto& [di, dj] : near_)
    if (inside(ci + di, cj + dj)) done_[at(ci + di, cj + dj)] = 1;
}

double FloorMap::covered_m2() const {
  return static_cast<double>(std::ranges::count(done_, 1)) * kCell_m * kCell_m;
}

bool FloorMap::passable(int i, int j) const {
  return inside(i, j) && evidence_[at(i, j)] < 0 && !blocked_[at(i, j)];
}

int FloorMap::to_be_covered_near(int i, int j) const {
  int count = 0;
  for (const auto& [di, dj] : near_)
    if (inside(i + di, j + dj) && evidence_[at(i + di, j + dj)] < 0 && done_[at(i + di, j + dj)] == 0)
      ++count;
  return count;
}

bool FloorMap::find_ways() {
  std::ranges::fill(blocked_, 0);
  for (int i = 0; i < kSide; ++i)
    for (int j = 0; j < kSide; ++j)
      if (evidence_[at(i, j)] >= kSomething)
        for (const auto& [di, dj] : keep_off_)
          if (inside(i + di, j + dj)) blocked_[at(i + di, j + dj)] = 1;
  std::ranges::fill(steps_, kNoWay);
  std::vector<std::array<int, 2>> front;
  for (int i = 0; i < kSide; ++i)
    for (int j = 0; j < kSide; ++j)
      if (passable(i, j) && to_be_covered_near(i, j) >= kWorthwhile) {
        steps_[at(i, j)] = 0;
        front.push_back({i, j});
      }
  const bool any = !front.empty();
  for (std::uint16_t steps = 1; !front.empty(); ++steps) {
    std::vector<std::array<int, 2>> next;
    for (const auto& [i, j] : front)
      for (const auto& [di, dj] : kNeighbours)
        if (passable(i + di, j + dj) && steps_[at(i + di, j + dj)] == kNoWay) {
          steps_[at(i + di, j + dj)] = steps;
          next.push_back({i + di, j + dj});
        }
    front = std::move(next);
  }
  return any;
}

double FloorMap::way_from(double x, double y) const {
  const auto [i, j] = cell(x, y);
  if (!inside(i, j) || steps_[at(i, j)] == kNoWay) return std::numeric_limits<double>::infinity();
  return steps_[at(i, j)] * kCell_m;
}

void FloorMap::give_up(double x, double y) {
  auto [i, j] = cell(x, y);
  if (!inside(i, j) || steps_[at(i, j)] == kNoWay) return;
  while (steps_[at(i, j)] > 0)
    for (const auto& [di, dj] : kNeighbours)
      if (inside(i + di, j + dj) && steps_[at(i + di, j + dj)] < steps_[at(i, j)]) {
        i += di;
        j += dj;
        break;
      }
  for (const auto& [di, dj] : near_)
    if (inside(i + di, j + dj) && done_[at(i + di, j + dj)] == 0) done_[at(i + di, j + dj)] = 2;
}

void FloorMap::save(plugin::StateOut& to) const {
  to.put(std::span<const std::int8_t>(evidence_));
  to.put(std::span<const std::uint8_t>(done_));
  to.put(std::span<const std::uint8_t>(blocked_));
  to.put(std::span<const std::uint16_t>(steps_));
}

void FloorMap::load(plugin::StateIn& from) {
  from.get(std::span<std::int8_t>(evidence_));
  from.get(std::span<std::uint8_t>(done_));
  from.get(std::span<std::uint8_t>(blocked_));
  from.get(std::span<std::uint16_t>(steps_));
}

}  // namespace visum::explorer
