#include "clients/visum/compare/campaigns.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "clients/visum/campaign/results.h"

namespace visum::compare {
namespace {

using campaign::Results;
using campaign::Row;
using campaign::Statement;
using Outcome = campaign::SequentialTest::Outcome;

constexpr std::size_t kMostDifferent = 1000;
constexpr double kZ = 1.959963984540054;  // 97.5 % of a normal distribution lie below it

struct Value {
  bool passed = false;
  std::optional<double> value;
  std::string unit;
};
using Values = std::vector<std::pair<std::string, Value>>;  // by check, in the scenario's order

// The checks of run after run.
class CheckReader {
 public:
  explicit CheckReader(Results& results)
      : found_(results.database(),
               "SELECT name, passed, value, unit FROM checks WHERE run = ? ORDER BY number") {}

  Values of(std::size_t run) {
    Values values;
    found_.reset().bind(run);
    while (found_.step())
      values.emplace_back(found_.text(0), Value{found_.integer(1) != 0, found_.real(2), found_.text(3)});
    return values;
  }

 private:
  Statement found_;
};

// Mean and spread of differences, summed up one after the other (Welford, 1962).
class Tally {
 public:
  void take(bool a, bool b) {
    ++(a ? (b ? check_.both : check_.only_a) : (b ? check_.only_b : check_.neither));
  }
  void take(std::uint64_t run, double difference) {
    ++count_;
    const double step = difference - mean_;
    mean_ += step / static_cast<double>(count_);
    squares_ += step * (difference - mean_);
    if (std::abs(difference) <= check_.max_abs) return;
    check_.max_abs = std::abs(difference);
    check_.max_run = run;
  }
  void set_unit(const std::string& unit) { check_.unit = unit; }

  CheckComparison result(const std::string& name) const {
    CheckComparison check = check_;
    check.check = name;
    check.p = mcnemar(check.only_a, check.only_b);
    if (count_ < 2) return check;
    const auto n = static_cast<double>(count_);
    const double half = kZ * std::sqrt(squares_ / (n - 1.0) / n);
    check.mean = mean_;
    check.low = mean_ - half;
    check.high = mean_ + half;
    return check;
  }

 private:
  CheckComparison check_;
  std::uint64_t count_ = 0;
  double mean_ = 0.0, squares_ = 0.0;
};

std::string recording_of(const Row& row, const std::filesystem::path& folder) {
  return row.recording.empty() ? std::string() : (folder / row.recording).string();
}

// Those with another verdict matter most, so that they are kept in place of others.
void note_different(CampaignComparison& result, const Row& one, const Row& other,
                    const std::filesystem::path& a, const std::filesystem::path& b) {
  RunPair pair{one.run,
               campaign::values_text(one),
               campaign::word_of(one.outcome()),
               campaign::word_of(other.outcome()),
               recording_of(one, a),
               recording_of(other, b)};
  ++result.different_count;
  if (pair.turned()) ++result.turned_count;
  auto& kept = result.different;
  if (kept.size() >= kMostDifferent) {
    const auto last =
        std::find_if(kept.rbegin(), kept.rend(), [](const RunPair& one) { return !one.turned(); });
    if (!pair.turned() || last == kept.rend()) return;
    kept.erase(std::next(last).base());
  }
  kept.push_back(std::move(pair));
}

// The files of the first run that both have, and what the heads say.
std::vector<std::string> settings_of(Results& a, Results& b) {
  std::vector<std::string> settings;
  const auto& of_a = a.identity();
  const auto& of_b = b.identity();
  if (of_a.build != of_b.build) settings.push_back("build: " + of_a.build + ", " + of_b.build);
  if (of_a.file != of_b.file)
    settings.push_back("scenario: " + of_a.file + ", " + of_b.file);
  else if (of_a.sweep != of_b.sweep)
    settings.push_back("the scenario's text, or an option such as --engine");
  const auto one = a.find(1), other = b.find(1);
  if (!one || !other) return settings;
  // A run's key is made of the scenario, the options, the build, and these.
  if (of_a.build == of_b.build && of_a.sweep == of_b.sweep && one->parameters == other->parameters &&
      one->key != other->key)
    settings.push_back("a controller's program, or a file that its command names");
  const auto files_a = a.files(one->files), files_b = b.files(other->files);
  for (const auto& [path, hash] : files_a) {
    const auto found = std::ranges::find(files_b, path, &std::pair<std::string, std::string>::first);
    if (found == files_b.end())
      settings.push_back("file of A only: " + path);
    else if (found->second != hash)
      settings.push_back("file: " + path);
  }
  for (const auto& [path, hash] : files_b)
    if (std::ranges::find(files_a, path, &std::pair<std::string, std::string>::first) == files_a.end())
      settings.push_back("file of B only: " + path);
  return settings;
}

}  // namespace

double mcnemar(std::uint64_t a, std::uint64_t b) {
  const auto n = static_cast<double>(a + b);
  double tail = 0.0;
  for (std::uint64_t i = 0, least = std::min(a, b); i <= least; ++i) {
    const auto k = static_cast<double>(i);
    tail +=
        std::exp(std::lgamma(n + 1.0) - std::lgamma(k + 1.0) - std::lgamma(n - k + 1.0) - n * std::log(2.0));
  }
  return std::min(1.0, 2.0 * tail);
}

CampaignComparison compare_campaigns(const std::filesystem::path& a, const std::filesystem::path& b) {
  Results in_a(a), in_b(b);
  CheckReader checks_a(in_a), checks_b(in_b);
  CampaignComparison result;
  Tally verdict;
  std::vector<std::string> order;
  std::map<std::string, Tally> tallies;
  std::uint64_t all_b = 0;
  in_b.for_each(in_b.identity().runs, [&](const Row&) { ++all_b; });
  in_a.for_each(in_a.identity().runs, [&](const Row& one) {
    const auto other = in_b.find(one.run);
    if (!other || other->parameters != one.parameters) {
      ++result.only_a;
      return;
    }
    ++result.runs;
    if (one.code != other->code || one.state_hash != other->state_hash) {
      note_different(result, one, *other, a, b);
    }
    if (one.outcome() == Outcome::kInvalid || other->outcome() == Outcome::kInvalid) {
      ++result.invalid;
      return;
    }
    verdict.take(one.outcome() == Outcome::kPassed, other->outcome() == Outcome::kPassed);
    const Values values_a = checks_a.of(one.run), values_b = checks_b.of(one.run);
    for (const auto& [name, value] : values_a) {
      const auto found = std::ranges::find(values_b, name, &Values::value_type::first);
      if (found == values_b.end()) continue;
      if (tallies.count(name) == 0) order.push_back(name);
      Tally& tally = tallies[name];
      tally.set_unit(value.unit);
      tally.take(value.passed, found->second.passed);
      if (value.value && found->second.value) tally.take(one.run, *found->second.value - *value.value);
    }
  });
  result.only_b = all_b - result.runs;
  std::stable_partition(result.different.begin(), result.different.end(),
                        [](const RunPair& pair) { return pair.turned(); });
  result.settings = settings_of(in_a, in_b);
  result.equal = result.different_count == 0 && result.only_a == 0 && result.only_b == 0;
  result.verdict = verdict.result("passed");
  for (const auto& name : order) result.checks.push_back(tallies.at(name).result(name));
  return result;
}

}  // namespace visum::compare
