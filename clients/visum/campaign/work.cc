#include "clients/visum/campaign/work.h"

#include <algorithm>
#include <exception>
#include <map>
#include <utility>

#include "clients/visum/campaign/content_key.h"
#include "clients/visum/campaign/keeper.h"
#include "clients/visum/common/interrupt.h"
#include "clients/visum/run/daemon.h"
#include "clients/visum/run/scenario_reader.h"
#include "clients/visum/run/sweep.h"
#include "protocol/config/flow.h"

namespace visum::campaign {
namespace {

constexpr std::size_t kChecked = 1000;

class Work {
 public:
  Work(const config::Node& root, const WorkOptions& options, Results& results)
      : options_(options),
        sweep_(root),
        keeper_(root, {options.folder, options.words, options.records, options.records_all, options.fresh},
                results),
        next_(options.shard.first()) {
    if (const auto& decide = results.identity().decide; decide && options.shard.count == 1)
      test_.emplace(*decide);
    progress_.all = options.shard.runs(sweep_.runs());
  }

  WorkDone go() {
    run::ManyOptions many{run::own_folder() / "visum", options_.file, sweep_.runs(), options_.jobs,
                          options_.words};
    if (options_.records) many.recordings = options_.folder;
    many.keeps_all = options_.records_all;
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
    while (next_ <= sweep_.runs() && !trouble_ && !is_decided() && !cli::interrupted()) {
      const std::size_t run = next_;
      next_ += options_.shard.count;
      const auto point = sweep_.point(run);
      try {
        const auto known = keeper_.find(run, point);
        if (!known) return run;
        ++progress_.reused;
        count(run, known->outcome());
      } catch (const config::ConfigError& error) {
        // A run whose scenario is wrong, with the values that it got.
        run::Report report;
        report.code = cli::kBadConfig;
        report.error = error.what();
        take(run, report);
      }
    }
    return 0;
  }

  bool is_decided() const { return test_ && test_->decision() != Decision::kUndecided; }

  // Never throws: other runs may go on just now.
  void take(std::size_t run, const run::Report& report) {
    if (report.code == cli::kInterrupted || trouble_) return;
    try {
      count(run, keeper_.keep(run, sweep_.point(run), report).outcome());
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

  const WorkOptions& options_;
  const run::Sweep sweep_;
  Keeper keeper_;
  std::size_t next_;  // run
  Progress progress_;
  std::optional<SequentialTest> test_;
  std::map<std::size_t, SequentialTest::Outcome> waiting_;  // for earlier runs
  std::size_t judged_ = 0;                                  // runs that the test has read
  std::exception_ptr trouble_;
};

}  // namespace

Identity identity_of(const config::Node& root, const std::filesystem::path& file,
                     const std::vector<std::string>& words) {
  const std::string text = config::flow(root) + deciding(words);
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
