// The pieces of a campaign's search: the evolution strategy, the places in the space, the worst case's file.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "clients/visum/campaign/evolution.h"
#include "clients/visum/campaign/worst_case.h"
#include "clients/visum/run/scenario_reader.h"
#include "clients/visum/run/search_spec.h"
#include "clients/visum/run/sweep.h"

namespace visum::campaign {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using Point = Evolution::Point;

struct Found {
  double value = std::numeric_limits<double>::infinity();
  Point at;
  std::size_t evaluations = 0;
};

// Minimises until it converges, or `most` evaluations are over.
Found minimise(Evolution evolution, const std::function<double(const Point&)>& function, std::size_t most) {
  Found found;
  while (!evolution.has_converged() && found.evaluations + evolution.population() <= most) {
    const auto points = evolution.ask();
    std::vector<double> values;
    for (const Point& point : points) {
      values.push_back(function(point));
      if (values.back() < found.value) {
        found.value = values.back();
        found.at = point;
      }
    }
    found.evaluations += points.size();
    evolution.tell(values);
  }
  return found;
}

double sphere(const Point& x) {
  double sum = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) sum += (x[i] - 0.7) * (x[i] - 0.7);
  return sum;
}

// A long valley, a thousand times as steep across as along, and not along an axis.
double valley(const Point& x) {
  double sum = 0.0;
  for (const double one : x) sum += one - 0.6;
  double squares = 0.0;
  for (const double one : x) squares += (one - 0.6) * (one - 0.6);
  return squares + 1000.0 * sum * sum;
}

TEST(Evolution, FindsTheBottomOfABowl) {
  for (const std::size_t axes : {1u, 2u, 8u}) {
    const auto found = minimise(Evolution(Point(axes, 0.2), 0.2, 0, 1), sphere, 5000);
    EXPECT_LT(found.value, 1e-9) << axes;
    EXPECT_LT(found.evaluations, 450 * axes + 300) << axes;
  }
}

TEST(Evolution, LearnsTheShapeOfAValley) {
  const auto found = minimise(Evolution(Point(6, 0.3), 0.2, 0, 3), valley, 20'000);
  EXPECT_LT(found.value, 1e-8);
  EXPECT_LT(found.evaluations, 6000u);
}

TEST(Evolution, FindsWhatLiesInACorner) {
  const auto corner = [](const Point& x) { return x[0] - x[1]; };
  const auto found = minimise(Evolution({0.5, 0.5}, 0.1, 0, 1), corner, 2000);
  EXPECT_LT(found.value, -0.999);
}

TEST(Evolution, StaysInsideAndComesToAnEndOnAPlateau) {
  Evolution evolution({0.01, 0.99}, 0.3, 10, 5);
  std::size_t generations = 0;
  for (; !evolution.has_converged() && generations < 1000; ++generations) {
    for (const Point& point : evolution.ask())
      for (const double share : point) {
        EXPECT_GT(share, 0.0);
        EXPECT_LT(share, 1.0);
      }
    evolution.tell(std::vector<double>(10, std::numeric_limits<double>::infinity()));
  }
  EXPECT_LT(generations, 50u);
}

TEST(Evolution, InfiniteValuesRankAsOthersDo) {
  const auto half = [](const Point& x) {
    return x[0] < 0.5 ? std::numeric_limits<double>::infinity() : (x[0] - 0.75) * (x[0] - 0.75);
  };
  EXPECT_LT(minimise(Evolution({0.45}, 0.1, 0, 1), half, 2000).value, 1e-9);
}

// The same on every processor and compiler: the hash of a search depends on it.
TEST(Evolution, HasTheseBits) {
  Evolution evolution({0.25, 0.5, 0.75}, 0.1, 6, 42);
  std::vector<Point> points;
  for (int generation = 0; generation < 20; ++generation) {
    points = evolution.ask();
    std::vector<double> values;
    for (const Point& point : points) values.push_back(valley(point));
    evolution.tell(values);
  }
  EXPECT_EQ(points.back(), (Point{0.40351204776713018, 0.67691716868350893, 0.74341686326879663}));
}

// A defect that fills 1 in 10,000 of the space: a ball around a point that no sample knows. The margin is the
// distance from it.
constexpr double kRadius = 0.0288;  // 4/3 pi r^3 = 1e-4
const Point kDefect{0.713, 0.287, 0.554};

double distance_from_defect(const Point& x) {
  double sum = 0.0;
  for (std::size_t i = 0; i < 3; ++i) sum += (x[i] - kDefect[i]) * (x[i] - kDefect[i]);
  return std::sqrt(sum) - kRadius;
}

std::size_t runs_until_found(const char* method, std::uint64_t seed) {
  const run::Sweep sweep(config::load_text(
      "sweep: {a: {uniform: [0, 1]}, b: {uniform: [0, 1]}, c: {uniform: [0, 1]}}\nsampling: {method: " +
          std::string(method) + ", runs: 100000, seed: " + std::to_string(seed) + "}",
      "s.yaml"));
  for (std::size_t run = 1; run <= sweep.runs(); ++run)
    if (distance_from_defect(sweep.shares(run)) < 0.0) return run;
  return sweep.runs() + 1;
}

// From the best of 100 samples, which count.
std::size_t runs_of_a_search(std::uint64_t seed) {
  const run::Sweep sweep(config::load_text(
      "sweep: {a: {uniform: [0, 1]}, b: {uniform: [0, 1]}, c: {uniform: [0, 1]}}\nsampling: {method: "
      "latin_hypercube, runs: 100, seed: " +
          std::to_string(seed) + "}",
      "s.yaml"));
  Point best;
  for (std::size_t run = 1; run <= 100; ++run) {
    const auto shares = sweep.shares(run);
    if (distance_from_defect(shares) < 0.0) return run;
    if (best.empty() || distance_from_defect(shares) < distance_from_defect(best)) best = shares;
  }
  std::size_t runs = 100;
  bool found = false;
  minimise(
      Evolution(best, 0.1, 0, seed),
      [&](const Point& x) {
        if (!found) ++runs;
        found = found || distance_from_defect(x) < 0.0;
        return distance_from_defect(x);
      },
      5000);
  return found ? runs : 100'000;
}

TEST(Evolution, FindsARareDefectWhenTheMarginLeadsThere) {
  std::vector<std::size_t> random, hypercube, sobol, search;
  for (std::uint64_t seed = 1; seed <= 9; ++seed) {
    random.push_back(runs_until_found("random", seed));
    hypercube.push_back(runs_until_found("latin_hypercube", seed));
    sobol.push_back(runs_until_found("sobol", seed));
    search.push_back(runs_of_a_search(seed));
  }
  const auto tell = [](const char* name, std::vector<std::size_t>& runs) {
    std::ranges::sort(runs);
    std::printf("%s: median %zu, least %zu, most %zu runs\n", name, runs[4], runs[0], runs[8]);
  };
  tell("random", random);
  tell("latin_hypercube", hypercube);
  tell("sobol", sobol);
  tell("search", search);
  EXPECT_GT(random[4], 3000u) << "the defect is rare";
  EXPECT_LT(search[8], 400u);
}

config::Node whole(const std::string& more) {
  return config::load_text(
      "visum_scenario: 1\nname: n\nscene: models/scenes/cart.yaml\nuntil: {at_s: 1}\n" + more,
      "folder/s.yaml", VISUM_SOURCE_DIR);
}

const std::string kChecks =
    "sweep: {a: {uniform: [0, 1]}, b: [x, y, z]}\nsampling: {method: sobol, runs: 8}\n"
    "checks:\n  - {name: one, that: {time: {}, above: 0}}\n  - {name: two, that: {time: {}, above: "
    "\"${a}\"}}\n";

std::string fault_of(const std::string& more) {
  try {
    run::read_scenario(whole(more));
  } catch (const config::ConfigError& error) {
    return error.what();
  }
  return "none";
}

TEST(SearchSpec, IsRead) {
  const auto search = run::read_search(whole(kChecks + "search: {check: two, runs: 50, until: broken}\n"));
  ASSERT_TRUE(search);
  EXPECT_EQ(search->check, 1u);
  EXPECT_EQ(search->runs, 50u);
  EXPECT_TRUE(search->until_broken);
  EXPECT_EQ(fault_of(kChecks + "search: {check: two, runs: 50, population: 12, seed: 3}\n"), "none");
}

TEST(SearchSpec, SaysWhatIsWrong) {
  EXPECT_THAT(fault_of(kChecks + "search: {runs: 50}\n"), HasSubstr("needs 'check'"));
  EXPECT_THAT(fault_of(kChecks + "search: {check: tow, runs: 50}\n"), HasSubstr("did you mean 'two'"));
  EXPECT_THAT(fault_of(kChecks + "search: {check: two}\n"), HasSubstr("runs"));
  EXPECT_THAT(fault_of("checks: [{that: {time: {}, above: 0}}]\nsearch: {runs: 5}\n"),
              HasSubstr("needs a 'sweep'"));
  EXPECT_THAT(fault_of("sweep: {a: [1]}\nsearch: {runs: 5}\n"), HasSubstr("needs 'checks'"));
}

TEST(Sweep, PlacesInTheSpaceLeadBackToTheirPoints) {
  for (const char* sampling : {"", "sampling: {method: latin_hypercube, runs: 12}\n"}) {
    const std::string sampled = *sampling ? "d: {normal: [0, 1]}, " : "";
    const run::Sweep sweep(whole("sweep: {" + sampled + "a: [1, 2], b: [x, y, z]}\n" + sampling));
    for (std::size_t run = 1; run <= sweep.runs(); ++run)
      EXPECT_EQ(sweep.point_at(sweep.shares(run)).described, sweep.point(run).described) << run;
  }
}

TEST(Sweep, TakesValuesThatAreGiven) {
  const run::Sweep sweep(whole(kChecks));
  const auto point = sweep.point_of(config::load_text("{b: q, a: 7}", "v"));
  EXPECT_EQ(point.described, (std::vector<std::pair<std::string, std::string>>{{"a", "7"}, {"b", "q"}}));
  for (const char* wrong : {"{a: 1}", "{a: 1, b: 2, c: 3}", "[1]"})
    EXPECT_THROW(sweep.point_of(config::load_text(wrong, "v")), config::ConfigError) << wrong;
}

TEST(WorstCase, IsAScenarioThatReadsBack) {
  const std::string more =
      "controllers: [{name: c, command: [\"{scenario_dir}/run\", \"a b\", \"${a}\"]}]\nengine: ode\n"
      "timeline: [{at_s: 0, say: \"$${x}\"}]\n";
  const auto root = whole(kChecks + more);
  const auto point = run::Sweep(root).point_of(config::load_text("{a: 0.30000000000000004, b: x}", "v"));
  const std::string text = scenario_at(root, point, "impulse", "the worst");
  EXPECT_THAT(text, HasSubstr("# the worst\n"));
  EXPECT_THAT(text, Not(HasSubstr("sweep:")));
  const auto scenario = run::read_scenario(config::load_text(text, "elsewhere.yaml", "/"));
  EXPECT_EQ(scenario.scene, std::filesystem::path(VISUM_SOURCE_DIR) / "models/scenes/cart.yaml");
  EXPECT_EQ(scenario.engine, "impulse");
  EXPECT_EQ(*scenario.checks.at(1).that.bounds.above, 0.30000000000000004);
  const auto& command = scenario.controllers.at(0).command;
  EXPECT_EQ(command.at(0), (std::filesystem::current_path() / "folder/run").string());
  EXPECT_EQ(command.at(2), "0.30000000000000004");
  EXPECT_EQ(std::get<run::Say>(scenario.timeline.at(0).action).text, "${x}");
}

}  // namespace
}  // namespace visum::campaign
