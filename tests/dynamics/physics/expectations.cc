#include "tests/dynamics/physics/expectations.h"

#include <algorithm>
#include <array>
#include <stdexcept>

namespace visum::physics {
namespace {

using Bounds = std::vector<double>;

constexpr std::array kRows{"impulse", "impulse-order4", "impulse-order6", "impulse-iterate",
                           "ode",     "ode-quick"};

// By row, in the order of kRows; {}: why_not() tells why the case is not for it.
struct Line {
  const char* id;
  std::array<Bounds, kRows.size()> bounds;
};

const std::vector<Line> kLines{
    {"F1",
     {{{1e-13, 1e-12, 4e-12},
       {1e-13, 1e-12, 8e-12},
       {1e-13, 1e-12, 1e-11},
       {1e-13, 1e-12, 3e-12},
       {1e-12, 1e-12, 4e-12},
       {1e-12, 1e-12, 4e-12}}}},
    {"F2",
     {{{2e-14, 8e-8, 5e-11, 0.0005},
       {1e-13, 4e-11, 4e-10, 1e-6},
       {1e-13, 2e-10, 2e-10, 1e-6},
       {2e-14, 5e-08, 4e-11, 0.0004},
       {0.05, 0.03, 0.1, 2.7},
       {0.05, 0.03, 0.1, 2.7}}}},
    {"F2c", {{{2e-14, 6e-12}, {2e-14, 2e-11}, {2e-14, 1e-11}, {2e-14, 5e-12}, {0.15, 1}, {0.15, 1}}}},
    {"F3", {{{1e-12, 1e-12}, {1e-12, 1e-12}, {1e-12, 1e-12}, {1e-12, 1e-12}, {1e-12, 5e-6}, {1e-12, 5e-6}}}},
    {"F4",
     {{{0.0002, 0.00015}, {2e-8, 1e-8}, {3e-10, 1.5e-10}, {0.00015, 0.0001}, {0.008, 0.3}, {0.008, 0.3}}}},
    {"P1",
     {{{4e-6, 1e-5, 2e-5, 8e-5},
       {3e-12, 1e-11, 3e-11, 1e-10},
       {1e-12, 1e-12, 2e-12, 1e-11},
       {3e-06, 1e-05, 1.5e-05, 6e-05},
       {0.002, 0.004, 0.003, 0.004},
       {0.002, 0.004, 0.003, 0.004}}}},
    {"P1p", {{{2e-6}, {8e-10}, {8e-10}, {1.5e-06}, {0.00015}, {0.00015}}}},
    {"P2", {{{4e-6}, {3e-11}, {3e-11}, {3e-06}, {6e-5}, {6e-5}}}},
    {"P3",
     {{{8e-6, 0.0001, 0.003, 7e-5, 1e-7},
       {5e-11, 8e-10, 5e-9, 4e-9, 3e-11},
       {1e-12, 2e-12, 5e-11, 1e-11, 1e-13},
       {4e-06, 8e-05, 0.002, 7e-5, 3e-06},
       {0.004, 0.01, 0.01, 0.005, 0.0008},
       {0.004, 0.01, 0.01, 0.005, 0.0008}}}},
    {"P4",
     {{{8e-8, 3e-5, 0.001, 0.015, 1e-7},
       {6e-8, 3e-10, 1e-7, 1.5e-6, 1e-10},
       {6e-8, 8e-12, 4e-9, 4e-7, 1e-13},
       {5e-07, 2e-05, 0.001, 0.004, 8e-05},
       {0.003, 0.01, 1, 2, 0.0015},
       {0.003, 0.008, 0.8, 2, 0.002}}}},
    {"P6", {{{0.0004}, {0.004}, {0.015}, {0.8}, {0.15}, {0.3}}}},
    {"P7", {{{1e-12}, {4e-12}, {1e-12}, {1e-12}, {0.008}, {0.008}}}},
    {"C1",
     {{{1e-7, 2e-6, 1e-7, 1.5e-7},
       {2e-11, 8e-11, 1.5e-12, 4e-11},
       {1e-13, 1e-12, 1e-13, 1e-12},
       {3e-06, 1.5e-05, 2e-05, 5e-05},
       {3e-5, 0.0006, 6e-7, 4e-5},
       {4e-5, 0.0008, 0.0006, 0.003}}}},
    {"C2",
     {{{1e-7, 1.5e-6}, {1e-10, 1.5e-10}, {1e-13, 3e-12}, {4e-05, 0.0002}, {4e-6, 0.0005}, {0.0015, 0.008}}}},
    {"C2k", {{{1e-7, 4e-6}, {1e-10, 3e-8}, {1e-13, 1.5e-8}, {0.0005, 0.003}, {5e-6, 0.0006}, {0.02, 0.08}}}},
    {"C3", {{{1e-7, 8e-9}, {2e-11, 1e-12}, {1e-13, 1e-12}, {0.00015, 6e-05}, {5e-6, 2e-6}, {0.002, 0.0015}}}},
    {"L1",
     {{{1e-5, 4e-5, 0.0008, 1e-10},
       {8e-8, 3e-6, 1e-5, 1.5e-11},
       {8e-8, 3e-6, 1e-5, 6e-11},
       {1e-05, 0.015, 0.02, 1e-05},
       {0.0006, 0.015, 0.2, 0.00015},
       {0.0008, 0.03, 0.3, 0.00015}}}},
    {"L1n", {{{2e-5, 1e-10}, {3e-8, 2e-11}, {4e-12, 1e-12}, {}, {0.06, 3e-6}, {0.06, 3e-6}}}},
    {"L2",
     {{{4e-5, 0.002, 1e-10}, {1.5e-9, 2e-8, 3e-11}, {5e-8, 3e-6, 1e-11}, {0.0001, 0.015, 8e-06}, {}, {}}}},
    {"L3",
     {{{3e-6, 1e-10, 0},
       {6e-12, 1e-11, 0},
       {3e-12, 1e-11, 0},
       {1.5e-05, 2e-06, 0},
       {0.02, 8e-5, 0},
       {0.002, 0.00015, 0}}}},
    {"L4", {{{6e-5, 2e-4, 1e-12}, {6e-5, 2e-4, 1e-12}, {6e-5, 2e-4, 1e-12}, {}, {}, {}}}},
    {"K1", {{{3e-7}, {}, {}, {3e-07}, {0.001}, {0.001}}}},
    {"K2", {{{1e-10}, {}, {}, {1e-12}, {5e-6}, {5e-6}}}},
    {"K3", {{{3e-6, 1e-10}, {}, {}, {2e-06, 1e-12}, {0.002, 1e-12}, {0.002, 1.5e-7}}}},
    {"K6", {{{3e-6}, {}, {}, {3e-06}, {4e-5}, {4e-5}}}},
    {"K7", {{{3e-8, 1e-8}, {}, {}, {6e-8, 6e-9}, {1e-6, 0.00015}, {0.002, 2e-5}}}},
    {"K8", {{{4e-8, 1e-8}, {}, {}, {2e-9, 2e-9}, {1e-12, 1e-12}, {0.015, 8e-5}}}},
    {"K4",
     {{{1e-10, 1e-10, 1.5e-6}, {}, {}, {5e-12, 6e-12, 1e-06}, {0.006, 0.008, 0.02}, {0.006, 0.008, 0.02}}}},
    {"K5", {{{1e-10, 1e-10}, {}, {}, {8e-11, 1e-12}, {0.1, 1e-12}, {0.1, 1e-12}}}},
    {"K9",
     {{{0.001, 2e-6, 1e-12}, {}, {}, {0.001, 2e-6, 1e-12}, {0.001, 3e-5, 1e-12}, {0.001, 4e-5, 1e-12}}}},
    {"K9e", {{{2e-12}, {}, {}, {2e-12}, {0.15}, {0.15}}}},
    {"K10", {{{3e-6, 1e-6}, {}, {}, {3e-6, 1e-6}, {1, 0.4}, {1, 0.4}}}},
    {"K11", {{{1e-10, 1e-10}, {}, {}, {5e-5, 1e-10}, {1e-8, 1e-12}, {0.5, 1}}}},
    {"K11e",
     {{{1e-7, 1.5e-9}, {1e-11, 1e-12}, {1e-12, 1e-12}, {2e-7, 1.5e-9}, {0.004, 0.03}, {0.004, 0.03}}}},
    {"K11m", {{{1e-14, 3e-14, 0}, {}, {}, {1e-13, 1e-13, 0}, {1e-12, 4e-4, 0}, {1e-12, 4e-4, 0}}}},
    {"G1",
     {{{1e-10, 3e-9, 2e-8, 3e-7, 0},
       {},
       {},
       {1e-10, 5e-9, 2e-8, 3e-7, 0},
       {3e-9, 2e-7, 5e-7, 6e-6, 0},
       {3e-7, 4e-5, 0.003, 0.02, 0}}}},
    {"G1c",
     {{{1e-10, 8e-8, 6e-7, 1.2e-5, 0},
       {},
       {},
       {1e-10, 1.5e-7, 6e-7, 1.5e-5, 0},
       {4e-9, 8e-7, 3e-6, 0.0002, 0},
       {2e-7, 0.015, 0.02, 0.1, 11}}}},
    {"G2", {{{2e-9, 0.0005}, {}, {}, {2e-9, 0.0005}, {1e-8, 0.002}, {3e-5, 1}}}},
    {"S1",
     {{{5e-12, 1e-12, 1e-12, 1e-12},
       {},
       {},
       {8e-10, 1e-12, 1e-12, 1e-12},
       {0.00051, 1e-12, 1e-12, 1e-12},
       {0.00051, 1e-12, 1e-12, 1e-12}}}},
    {"S2",
     {{{1e-12, 1e-12, 1e-12},
       {},
       {},
       {1e-12, 1e-12, 1e-12},
       {1e-12, 0.00051, 1e-12},
       {1e-12, 0.00051, 1e-12}}}},
    {"S1h", {{{1e-12, 1e-12}, {}, {}, {1e-12, 1e-12}, {2e-8, 1e-12}, {1.5e-5, 0.004}}}},
    {"S3", {{{1e-12, 3e-9}, {}, {}, {1e-12, 3e-09}, {0.0006, 1e-12}, {0.0006, 1e-12}}}},
    {"A1", {{{}, {}, {}, {0.00015, 4e-08, 1e-12}, {}, {}}}},
    {"A2", {{{0, 0}, {0, 0}, {0, 0}, {0, 0}, {}, {}}}},
    {"D1", {{{0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}}}},
    {"D2", {{{0, 0}, {}, {}, {0, 0}, {0, 0}, {0, 0}}}},
    {"P8", {{{8e-6, 0.0002}, {6e-8, 7e-8}, {6e-10, 6e-10}, {}, {0.3, 0.4}, {0.4, 0.4}}}},
    {"C1l", {{{5e-8, 1.5e-6}, {5e-11, 6e-9}, {1e-13, 8e-9}, {}, {4e-6, 3e-5}, {0.0015, 0.0004}}}},
    {"K7l", {{{3e-8, 1e-8}, {}, {}, {}, {1e-6, 0.00015}, {0.1, 3e-5}}}},
    {"G1l",
     {{{0.001, 0.001, 0.001, 0.001, 0.001, 0.001, 0},
       {},
       {},
       {},
       {},
       {1.5e-6, 0.005, 0.1, 0.1, 0.1, 0.1, 32}}}},
    {"G1lc",
     {{{0.001, 0.001, 0.001, 0.001, 0.001, 0.001, 0}, {}, {}, {}, {}, {4e-6, 0.1, 0.1, 0.1, 0.1, 0.1, 35}}}},
};

bool is_of_higher_order(const std::string& row) {
  return row == "impulse-order4" || row == "impulse-order6";
}

const std::vector<Miss> kMisses{};

std::string why_not(const std::string& id, const std::string& row) {
  if (is_of_higher_order(row) && (std::string("KGS").find(id[0]) != std::string::npos || id == "D2"))
    return "with contacts, drives or stops a step is of order 2: as impulse";
  if (id == "A1") return "has no budget of corrections: all runs would be the same";
  if (id == "A2") return "has no bound for its joints' gaps";
  if (id == "L4" && row == "impulse-iterate")
    return "a shaft of 5e-6 kg·m² that carries 10 kg·m² is too much for joint after joint: it breaks, and "
           "says so";
  if (id == "L2" || id == "L4") return "has no springs";
  if (find_case(id).takes_long && row == "impulse-iterate")
    return "minutes of computing: the case of the same letter that takes less shows it";
  if (id.starts_with("G1l") && row == "ode")
    return "more than three minutes of computing: G1 and G1c show it";
  throw std::logic_error("no bounds and no reason for case " + id + " with " + row);
}

std::vector<Expectation> all_expectations() {
  std::vector<Expectation> all;
  for (const Line& line : kLines) {
    for (std::size_t i = 0; i < kRows.size(); ++i) {
      const Bounds& bounds = line.bounds[i];
      all.push_back({line.id, kRows[i], bounds, bounds.empty() ? why_not(line.id, kRows[i]) : ""});
    }
  }
  return all;
}

}  // namespace

const std::vector<Expectation>& expectations() {
  static const std::vector<Expectation> all = all_expectations();
  return all;
}

const std::vector<Miss>& declared_misses() {
  return kMisses;
}

const Expectation* find_expectation(const std::string& id, const std::string& row) {
  const auto found = std::ranges::find_if(
      expectations(), [&](const Expectation& one) { return one.id == id && one.row == row; });
  return found == expectations().end() ? nullptr : &*found;
}

bool is_expected_right(const Case& what, std::size_t i, const EngineRow& row) {
  const Expectation* expectation = find_expectation(what.id, row.name);
  return expectation && expectation->bounds.at(i) <= what.figures[i].demand(row.setting);
}

}  // namespace visum::physics
