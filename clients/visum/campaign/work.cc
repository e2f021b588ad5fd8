#include "clients/visum/campaign/work.h"

#include <unistd.h>

#include <algorithm>
#include <exception>
#include <map>
#include <utility>

#include "clients/visum/campaign/content_key.h"
#include "clients/visum/common/interrupt.h"
#include "clients/visum/common/json_writer.h"
#include "clients/visum/run/daemon.h"
#include "clients/visum/run/scenario_reader.h"
#include "clients/visum/run/sweep.h"
#include "protocol/config/flow.h"

namespace visum::campaign {
namespace {

constexpr std::size_t kChecked = 1000;

std::string host_name() {
  char name[256] = "";
  ::gethostname(name, sizeof name - 1);
  return name;
}

std::string as_json(const std::vector<std::pair<std::string, std::string>>& swept) {
  cli::JsonWriter json;
  json.begin_object();
  for (const auto& [name, value] : swept) json.member(name, value);
  return json.end_object().text();
}

// Why a run failed, on one line.
std::string trouble_of(const run::Report& report) {
  std::string text = report.error.substr(0, report.error.find('\n'));
  const auto add = [&](const std::string& one) { text += (text.empty() ? "" : "; ") + one; };
  for (const auto& failure : report.failures) add(failure);
  for (const auto& check : report.checks)
    if (!check.passed && report.error.empty()) add(check.name);
  return text;
}

class Work {
 public:
  Work(const config::Node& root, const WorkOptions& options, Results& results)
      : root_(root),
        options_(options),
        results_(results),
        sweep_(root),
        keys_(root, options.words, results.identity().build),
        next_(options.shard.first()) {
    if (const auto& decide = results.identity().decide; decide && options.shard.count == 1)
      test_.emplace(*decide);
    progress_.all = options.shard.runs(sweep_.runs());
  }

  WorkDone go() {
    run::ManyOptions many{run::own_folder() / "visum", options_.file, sweep_.runs(), options_.jobs,
                          options_.words};
    if (options_.records) many.recordings = options_.folder;
    many.next = [this] { return next(); };
    many.on_done = [this](std::size_t run, const run::Report& report) { take(run, report); };
    WorkDone done;
    done.stopped = run::run_each(many);
    if (trouble_) std::rethrow_exception(trouble_);
    if (!done.stopped && cli::interrupted())
      done.stopped = run::Stopped{next_, cli::kInterrupted, "interrupted"};
    done.progress = progress_;
    return done;
  }

 private:
  // The next run that must be made; 0: none.
  std::size_t next() {
    for (; next_ <= sweep_.runs() && !trouble_ && !is_decided() && !cli::interrupted();
         next_ += options_.shard.count) {
      const std::size_t run = next_;
      std::optional<Row> known;
      try {
        const auto scenario = run::read_scenario(root_, run);
        keys_of_[run] = keys_.key(scenario, run);
        known = reusable(scenario, run);
      } catch (const config::ConfigError& error) {
        refuse(run, error);
        continue;
      }
      if (!known) {
        next_ += options_.shard.count;
        return run;
      }
      keys_of_.erase(run);
      ++progress_.reused;
      count(run, known->outcome());
    }
    return 0;
  }

  bool is_decided() const { return test_ && test_->decision() != Decision::kUndecided; }

  std::optional<Row> reusable(const run::Scenario& scenario, std::size_t run) {
    if (options_.fresh) return std::nullopt;
    const std::string& key = keys_of_[run];
    auto row = results_.find(run);
    const bool ours = row && row->key == key;
    if (!ours) row = results_.find_earlier(key);
    if (!row || !row->reusable || row->files == 0 || !scenario.record.empty()) return std::nullopt;
    if (!keys_.find_change(results_.files(row->files)).empty()) return std::nullopt;
    std::error_code none;
    if (options_.records && row->code != cli::kDone &&
        (row->recording.empty() || !std::filesystem::exists(options_.folder / row->recording, none)))
      return std::nullopt;
    if (!ours) results_.adopt(*row, run, as_json(sweep_.described(run)));
    return row;
  }

  // A run whose scenario is wrong, with the values that it got.
  void refuse(std::size_t run, const config::ConfigError& error) {
    run::Report report;
    report.code = cli::kBadConfig;
    report.error = error.what();
    take(run, report);
  }

  // Never throws: other runs may go on just now.
  void take(std::size_t run, const run::Report& report) {
    if (report.code == cli::kInterrupted || trouble_) return;
    try {
      Row row;
      row.run = run;
      row.parameters = as_json(sweep_.described(run));
      row.code = report.code;
      row.error = trouble_of(report);
      row.state_hash = report.state_hash;
      row.ticks = report.ticks;
      row.sim_seconds = report.sim_seconds;
      row.key = std::exchange(keys_of_[run], {});
      row.reusable = report.clock == "lockstep" &&
                     (report.code == cli::kDone || report.code == cli::kFailed) && !report.files.empty();
      if (!report.recording.empty())
        row.recording = std::filesystem::path(report.recording).filename().string();
      keys_of_.erase(run);
      results_.add(row, report, host_);
      count(row.run, row.outcome());
    } catch (...) {
      trouble_ = std::current_exception();
    }
  }

  void count(std::size_t run, SequentialTest::Outcome outcome) {
    using Outcome = SequentialTest::Outcome;
    ++progress_.done;
    ++(outcome == Outcome::kPassed   ? progress_.passed
       : outcome == Outcome::kFailed ? progress_.failed
                                     : progress_.invalid);
    if (test_) {
      waiting_[run] = outcome;
      for (auto first = waiting_.begin(); first != waiting_.end() && first->first == judged_ + 1;
           first = waiting_.erase(first), ++judged_)
        test_->take(first->second);
    }
    if (options_.on_progress) options_.on_progress(progress_);
  }

  const config::Node& root_;
  const WorkOptions& options_;
  Results& results_;
  const run::Sweep sweep_;
  ContentKeys keys_;
  std::size_t next_;                            // run
  std::map<std::size_t, std::string> keys_of_;  // of runs that go on now
  Progress progress_;
  std::optional<SequentialTest> test_;
  std::map<std::size_t, SequentialTest::Outcome> waiting_;  // for earlier runs
  std::size_t judged_ = 0;                                  // runs that the test has read
  const std::string host_ = host_name();
  std::exception_ptr trouble_;
};

}  // namespace

Identity identity_of(const config::Node& root, const std::filesystem::path& file,
                     const std::vector<std::string>& words) {
  std::string text = config::flow(root);
  for (const auto& word : words) text += '\0' + word;
  return {root.get("name").text(), file.string(),         hash_text(text), build_id(),
          run::Sweep(root).runs(), run::read_decide(root)};
}

void check_scenarios(const config::Node& root, const Shard& shard) {
  const std::size_t all = run::Sweep(root).runs(), mine = shard.runs(all);
  const std::size_t checked = std::min(mine, kChecked);
  for (std::size_t i = 0; i < checked; ++i) {
    const std::size_t which = checked == 1 ? 0 : (mine - 1) / (checked - 1) * i;
    const auto scenario = run::read_scenario(root, shard.first() + which * shard.count);
    if (!scenario.record.empty())
      root.get("record").fail("is for single runs; a campaign keeps recordings of runs that fail");
  }
}

WorkDone work(const config::Node& root, const WorkOptions& options, Results& results) {
  return Work(root, options, results).go();
}

}  // namespace visum::campaign
