#include "clients/visum/campaign/search.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <iterator>
#include <limits>
#include <utility>
#include <vector>

#include "clients/visum/campaign/evolution.h"
#include "clients/visum/campaign/keeper.h"
#include "clients/visum/campaign/run_hash.h"
#include "clients/visum/campaign/worst_case.h"
#include "clients/visum/common/format.h"
#include "clients/visum/common/interrupt.h"
#include "clients/visum/common/whole_file.h"
#include "clients/visum/run/daemon.h"
#include "clients/visum/run/sampling.h"
#include "clients/visum/run/sweep.h"
#include "protocol/config/exp_log.h"

namespace visum::campaign {
namespace {

constexpr std::size_t kMostStarts = 1000;  // that are known from the campaign; further ones are random
constexpr double kInfinity = std::numeric_limits<double>::infinity();

class Search {
 public:
  Search(const config::Node& root, const run::SearchSpec& spec, const WorkOptions& options, Results& results,
         std::size_t last)
      : root_(root),
        spec_(spec),
        options_(options),
        results_(results),
        last_(last),
        sweep_(root),
        first_(sweep_.runs() + 1),
        keeper_(root, {options.folder, options.words, options.records, options.records_all, options.fresh},
                results) {
    progress_.what = "search, ";
    progress_.all = spec.runs;
  }

  SearchDone go() {
    find_starts();
    while (may_go_on()) climb_down(next_start());
    done_.runs = made_;
    done_.hash = hash_of_runs(results_, first_, first_ + made_ - 1);
    find_worst();
    return done_;
  }

 private:
  using Point = Evolution::Point;

  bool may_go_on() const {
    return made_ < spec_.runs && !done_.stopped && !(spec_.until_broken && done_.broken > 0);
  }

  // The distance between neighbours, if the campaign's points lay on a grid.
  double spacing() const {
    const double axes = static_cast<double>(sweep_.axes());
    return config::exponential(-config::logarithm(static_cast<double>(last_)) / axes);
  }

  void find_starts() {
    Statement found(
        results_.database(),
        "SELECT runs.run FROM checks JOIN runs ON runs.run = checks.run WHERE checks.number = ? AND "
        "checks.run > 0 AND checks.run <= ? AND margin IS NOT NULL AND code IN (0, 1, 4) "
        "ORDER BY margin, runs.run LIMIT " +
            std::to_string(kMostStarts));
    found.bind(spec_.check + 1).bind(last_);
    while (found.step()) starts_.push_back(sweep_.shares(found.size(0)));
  }

  // The best point of the campaign that is not next to one that was used. Where there is none, any point.
  Point next_start() {
    while (next_start_ < starts_.size()) {
      const Point& start = starts_[next_start_++];
      const auto near = [&](const Point& used) {
        for (std::size_t i = 0; i < used.size(); ++i)
          if (std::abs(used[i] - start[i]) > spacing()) return false;
        return true;
      };
      if (std::ranges::none_of(used_, near)) return start;
    }
    Point any(sweep_.axes());
    for (std::size_t axis = 0; axis < any.size(); ++axis)
      any[axis] = run::random_share(spec_.seed, axis + any.size(), done_.starts);
    return any;
  }

  void climb_down(const Point& start) {
    used_.push_back(start);
    Evolution evolution(start, std::clamp(0.5 * spacing(), 0.02, 0.3), spec_.population,
                        spec_.seed * kMostStarts + done_.starts);
    ++done_.starts;
    while (may_go_on() && !evolution.has_converged()) {
      auto points = evolution.ask();
      points.resize(std::min(points.size(), spec_.runs - made_));
      const auto values = measure(points);
      if (done_.stopped || values.size() < evolution.population()) return;
      evolution.tell(values);
      ++done_.generations;
    }
  }

  // Makes the runs of these points, several at a time. What they gave is read in their order.
  std::vector<double> measure(const std::vector<Point>& points) {
    const std::size_t begin = first_ + made_;
    std::size_t next = 0;
    std::exception_ptr trouble;
    const auto point = [&](std::size_t run) { return sweep_.point_at(points[run - begin]); };
    run::ManyOptions many{run::own_folder() / "visum", options_.file, first_ + spec_.runs, options_.jobs,
                          options_.words};
    if (options_.records) many.recordings = options_.folder;
    many.keeps_all = options_.records_all;
    many.values = [&](std::size_t run) { return values_text(point(run)); };
    many.on_done = [&](std::size_t run, const run::Report& report) {
      if (report.code == cli::kInterrupted || trouble) return;
      try {
        keeper_.keep(run, point(run), report);
        tell();
      } catch (...) {
        trouble = std::current_exception();
      }
    };
    many.next = [&]() -> std::size_t {
      while (next < points.size() && !trouble && !cli::interrupted()) {
        const std::size_t run = begin + next++;
        if (!is_known(run, point(run))) return run;
        ++done_.reused;
        tell();
      }
      return 0;
    };
    done_.stopped = run::run_each(many);
    if (trouble) std::rethrow_exception(trouble);
    if (!done_.stopped && cli::interrupted())
      done_.stopped = run::Stopped{begin + next, cli::kInterrupted, "interrupted"};
    if (done_.stopped) return {};
    made_ += points.size();
    std::vector<double> values;
    for (std::size_t i = 0; i < points.size(); ++i) values.push_back(judge(begin + i));
    return values;
  }

  // True where the run needs not be made: it was, or its scenario is wrong.
  bool is_known(std::size_t run, const run::SweepPoint& point) {
    try {
      return keeper_.find(run, point).has_value();
    } catch (const config::ConfigError& error) {
      run::Report report;
      report.code = cli::kBadConfig;
      report.error = error.what();
      keeper_.keep(run, point, report);
      return true;
    }
  }

  static std::string values_text(const run::SweepPoint& point) {
    std::string text;
    for (const auto& [name, value] : point.described)
      text += (text.empty() ? "{" : ", ") + name + ": " + value;
    return text + "}";
  }

  // The search makes this small: the check's margin. A run that failed before the check could be measured is
  // the worst find of all; one that is invalid is none.
  double judge(std::size_t run) {
    const auto row = results_.find(run);
    if (!row || row->outcome() == SequentialTest::Outcome::kInvalid) {
      ++done_.invalid;
      return kInfinity;
    }
    Statement found(results_.database(), "SELECT margin, passed FROM checks WHERE run = ? AND number = ?");
    const bool measured = found.bind(run).bind(spec_.check + 1).step() && found.real(0).has_value();
    const double value = measured ? *found.real(0) : row->code == cli::kDone ? kInfinity : -kInfinity;
    if (measured ? found.integer(1) == 0 : value < 0.0) {
      ++done_.broken;
      if (done_.first_broken == 0) done_.first_broken = run - first_ + 1;
    }
    return value;
  }

  void tell() {
    ++progress_.done;
    progress_.failed = done_.broken;
    progress_.invalid = done_.invalid;
    progress_.reused = done_.reused;
    if (options_.on_progress) options_.on_progress(progress_);
  }

  void find_worst() {
    const std::string end = std::to_string(first_ + made_ - 1), first = std::to_string(first_);
    Statement found(
        results_.database(),
        "SELECT runs.run, margin, name, unit, runs.state_hash FROM runs LEFT JOIN checks ON checks.run "
        "= runs.run AND checks.number = ?1 WHERE (runs.run BETWEEN 1 AND ?2 OR runs.run BETWEEN " +
            first + " AND " + end +
            ") AND code IN (0, 1, 4) AND (margin IS NOT NULL OR code <> 0) "
            "ORDER BY margin, runs.run LIMIT 1");
    done_.check = spec_.name;
    if (!found.bind(spec_.check + 1).bind(last_).step()) return;
    done_.worst_run = found.size(0);
    done_.margin = found.real(1);
    if (done_.margin) done_.check = found.text(2);
    done_.unit = found.text(3);
    write_worst(found.text(4));
  }

  // The results keep each value as YAML, in a string.
  run::SweepPoint point_of(const Row& row) const {
    const std::string origin = "the parameters of run " + std::to_string(row.run);
    const auto kept = config::load_text(row.parameters, origin);
    std::string text;
    for (const auto& name : kept.keys())
      text += (text.empty() ? "{" : ", ") + name + ": " + kept.get(name).text();
    return sweep_.point_of(config::load_text(text + "}", origin));
  }

  void write_worst(const std::string& state_hash) {
    const auto row = results_.find(done_.worst_run);
    const auto point = point_of(*row);
    for (const auto& [name, value] : point.described)
      done_.values += (done_.values.empty() ? "" : ", ") + name + "=" + value;
    const auto& words = options_.words;
    const auto engine = std::ranges::find(words, "--engine");
    done_.scenario = "worst.yaml";
    cli::write_whole_file(options_.folder / done_.scenario,
                          scenario_at(root_, point, engine != words.end() ? *std::next(engine) : "",
                                      "Run " + std::to_string(done_.worst_run) +
                                          " of the campaign: the worst that was found."));
    if (!options_.records || done_.stopped) return;
    // It is made once more, for the recording, and must end as it did.
    const auto recording = options_.folder / "worst.mcap";
    run::ManyOptions again{run::own_folder() / "visum",
                           options_.folder / done_.scenario,
                           1,
                           1,
                           {"--record", recording.string()}};
    if (std::ranges::find(words, "--no-cache") != words.end()) again.words.push_back("--no-cache");
    again.next = [begun = false]() mutable -> std::size_t { return std::exchange(begun, true) ? 0 : 1; };
    again.on_done = [&](std::size_t, const run::Report& report) {
      if (report.recording_trouble.empty())
        done_.recording = recording.filename().string();
      else
        done_.trouble = "worst.mcap " + report.recording_trouble;
      if (cli::hex(report.state_hash) != state_hash)
        done_.trouble =
            "made once more, the worst run ended in another state: its controllers or scene are not "
            "deterministic" +
            (report.error.empty() ? "" : " (" + report.error + ")");
    };
    if (const auto stopped = run::run_each(again)) done_.trouble = "worst.mcap: " + stopped->why;
  }

  const config::Node& root_;
  const run::SearchSpec& spec_;
  const WorkOptions& options_;
  Results& results_;
  const std::size_t last_;  // run of the campaign that counts
  const run::Sweep sweep_;
  const std::size_t first_;  // run of the search
  Keeper keeper_;
  std::vector<Point> starts_, used_;
  std::size_t next_start_ = 0, made_ = 0;
  SearchDone done_;
  Progress progress_;
};

}  // namespace

SearchDone search(const config::Node& root, const run::SearchSpec& spec, const WorkOptions& options,
                  Results& results, std::size_t last) {
  return Search(root, spec, options, results, last).go();
}

}  // namespace visum::campaign
