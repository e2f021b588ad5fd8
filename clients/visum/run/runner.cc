#include "clients/visum/run/runner.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <set>

#include "clients/visum/common/format.h"
#include "clients/visum/common/temp_folder.h"
#include "clients/visum/run/actions.h"
#include "clients/visum/run/announcements.h"
#include "clients/visum/run/bounds.h"
#include "clients/visum/run/check_news.h"
#include "clients/visum/run/daemon.h"
#include "clients/visum/run/exchanges.h"
#include "clients/visum/run/run_profile.h"
#include "clients/visum/run/session.h"
#include "clients/visum/run/timeline.h"
#include "clients/visum/run/verdict.h"

namespace visum::run {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kRounding_s = 1e-9;  // see check.cc

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

double sim_seconds(const Observation& now) {
  return static_cast<double>(now.world.sim_time_ns) * 1e-9;
}

std::map<std::string, std::string> placeholder_values(const Scenario& scenario, const Daemon& daemon) {
  const std::string number = std::to_string(daemon.port());
  const auto folder = scenario.file.parent_path();
  std::map<std::string, std::string> values{{"connect", "127.0.0.1:" + number},
                                            {"host", "127.0.0.1"},
                                            {"port", number},
                                            {"scenario_dir", folder.empty() ? "." : folder.string()},
                                            {"scene", scenario.scene.string()},
                                            {"bin", own_folder().string()},
                                            {"seed", std::to_string(scenario.seed.value_or(0))},
                                            {"clock", scenario.clock}};
  for (const auto& [part, place] : daemon.buses()) values["bus." + part] = place;
  return values;
}

std::vector<std::string> bus_options(const Scenario& scenario, const cli::TempFolder& links) {
  std::vector<std::string> options;
  for (const auto& [part, kind] : scenario.buses)
    options.push_back(part + "=" + kind + ":" +
                      (kind == "tcp" ? "0" : (links.path() / (part + "." + kind)).string()));
  return options;
}

void note_part(const Condition& condition, std::set<std::string>& parts) {
  if (condition.quantity.kind == "port") parts.insert(condition.quantity.part);
}

// The parts whose ports a check, the time line or `until` reads; no others are read.
std::set<std::string> parts_needed(const Scenario& scenario) {
  std::set<std::string> parts;
  for (const auto& check : scenario.checks) note_part(check.that, parts);
  for (const auto& entry : scenario.timeline) {
    if (entry.when) note_part(*entry.when, parts);
  }
  if (scenario.until.condition) note_part(*scenario.until.condition, parts);
  return parts;
}

// One run, once the daemon is ready.
class Run {
 public:
  Run(const Scenario& scenario, const RunOptions& options, Daemon& daemon, WaitLoop& wait_loop,
      Report& report)
      : scenario_(scenario),
        options_(options),
        daemon_(daemon),
        wait_loop_(wait_loop),
        report_(report),
        session_(daemon.port(), wait_loop),
        parts_(parts_needed(scenario)),
        profile_(options.profile != nullptr ? &options.profile->runner() : nullptr),
        phases_(profile_),
        controllers_(scenario.controllers, placeholder_values(scenario, daemon), session_, wait_loop,
                     [this](const std::string& who, const std::string& line) { tell(who, line); }) {}

  void go();
  void collect();  // what is known so far, into the report
  // Looks at the server for the last time, so that why_invalid() and silent_controller() know what was.
  // The report notes the limits that the run has met.
  void look_back();
  std::string why_invalid() const { return run::why_invalid({}, last_, scenario_.max_overruns); }
  std::string silent_controller() const { return find_silent_controller(scenario_.controllers, last_); }
  std::string out_of_step() const { return controllers_.out_of_step(); }
  void keep();
  void end_world() { session_.end_world(); }

 private:
  void prepare();
  void tie_again();
  void note_members();
  // Lets one step pass. False: the world stands where it was, because a member came or left.
  bool step();
  void send_steps();
  bool may_go_on(double sim_s) const;
  void pace();
  void act();
  bool is_over();
  void note_unfinished();
  void tell(const std::string& who, const std::string& line) {
    options_.on_line(who, line);
    announcements_.add_line(who, line);
  }
  void tell(const CheckResult& check) {
    announcements_.add_check(check);
    if (options_.on_check) options_.on_check(check);
  }

  const Scenario& scenario_;
  const RunOptions& options_;
  Daemon& daemon_;
  WaitLoop& wait_loop_;
  Report& report_;
  Session session_;
  Announcements announcements_;
  const std::set<std::string> parts_;
  config::Profile* const profile_;  // null: nobody measures
  const RunnerPhases phases_;
  Controllers controllers_;
  Catalogue catalogue_;
  std::vector<Check> checks_;
  CheckNews news_{[this](const CheckResult& check) { tell(check); }};
  std::optional<Timeline> timeline_;
  std::optional<Actions> actions_;
  std::optional<Quantity> until_;
  Observation now_;
  protocol::ServerStatus last_;
  std::int64_t step_ticks_ = 1;
  std::uint32_t members_ = 0;           // of the lockstep
  std::optional<double> settled_at_s_;  // when `until` came true
  Clock::time_point began_ = Clock::now();
  Clock::time_point due_{};  // pace()
};

void Run::prepare() {
  session_.join();
  catalogue_ = session_.catalogue();
  for (const auto& spec : scenario_.checks) checks_.emplace_back(spec, catalogue_);
  timeline_.emplace(scenario_.timeline, catalogue_);
  actions_.emplace(session_, controllers_, catalogue_,
                   [this](const std::string& text) { tell("scenario", text); });
  if (scenario_.until.condition) until_ = tie(scenario_.until.condition->quantity, catalogue_);
  const double tick_ms = static_cast<double>(session_.tick_ns()) * 1e-6;
  step_ticks_ = std::max<std::int64_t>(1, std::llround(scenario_.check_every_ms / tick_ms));
  if (scenario_.max_sim_s * 1e3 / tick_ms > static_cast<double>(Session::kMostTicks)) {
    throw config::ConfigError({scenario_.file.string(), 0, "max_sim_s"}, "must be at most 900 million ticks");
  }
  {
    const config::ProfileScope measured(profile_, phases_.controllers);
    controllers_.start(scenario_.start_wall_s);
  }
  now_ = session_.look(parts_);
  members_ = static_cast<std::uint32_t>(session_.status().lockstep.size());
}

// Bodies came or went, so the same names have other indices now.
void Run::tie_again() {
  catalogue_ = session_.catalogue();
  for (Check& check : checks_) check.tie_again(catalogue_);
  timeline_->tie_again(catalogue_);
  if (until_) run::tie_again(*until_, catalogue_);
}

// The whole scenario: due actions while the world stands, then a step, then the checks look at the new state.
void Run::go() {
  prepare();
  began_ = Clock::now();
  if (profile_ != nullptr) profile_->enter(phases_.checks);  // until run_with() enters the end
  act();
  while (!is_over()) {
    if (!step()) continue;
    for (Check& check : checks_) check.observe(now_);
    news_.look(checks_, sim_seconds(now_));
    if (options_.on_step) options_.on_step(sim_seconds(now_));
    act();
  }
  note_unfinished();
}

// True if nothing is known by now that would end the run, or be due, at that time.
bool Run::may_go_on(double sim_s) const {
  double until_s = std::min(scenario_.max_sim_s, timeline_->next_s());
  if (settled_at_s_) until_s = std::min(until_s, *settled_at_s_ + scenario_.settle_s);
  if (!settled_at_s_ && scenario_.until.kind == Until::Kind::kTime)
    until_s = std::min(until_s, scenario_.until.at_s);
  return sim_s < until_s - kRounding_s;
}

// Sends steps ahead where nothing that we see in one can decide whether the next one is made. Then the world
// does not wait for us: it goes on while we check.
void Run::send_steps() {
  const bool lockstep = session_.clock() == "lockstep";
  const bool to_controllers = scenario_.until.kind == Until::Kind::kControllers && !settled_at_s_;
  const bool looks = scenario_.until.kind == Until::Kind::kCondition && !settled_at_s_;
  // The first step comes before anybody can have left.
  const bool follows = lockstep && to_controllers && now_.world.tick > 0;
  const bool alone = lockstep && !looks && !options_.keep && !timeline_->has_conditions() &&
                     !controllers_.any_in_real_time() &&
                     (!to_controllers || (follows && controllers_.all_joined()));
  const std::size_t most = alone ? Session::most_steps(parts_) : 1;
  const std::size_t ahead = session_.steps_ahead();
  if (ahead > most / 2) return;
  const auto step_s = static_cast<double>(step_ticks_ * session_.tick_ns()) * 1e-9;
  std::size_t count = ahead == 0 ? 1 : 0;
  while (ahead + count < most && may_go_on(sim_seconds(now_) + static_cast<double>(ahead + count) * step_s))
    ++count;
  if (count == 0) return;
  session_.send_steps(count, step_ticks_, parts_, follows ? members_ : 0);
  controllers_.check_ends();
}

bool Run::step() {
  if (controllers_.any_in_real_time()) pace();
  const config::ProfileScope measured(profile_, phases_.world);
  send_steps();
  auto now = session_.take_step();
  controllers_.note_timeouts();
  announcements_.flush(session_);
  if (!now) {
    note_members();
    return false;
  }
  now_ = std::move(*now);
  if (now_.world.revision != catalogue_.world.revision) tie_again();
  if (scenario_.until.kind == Until::Kind::kControllers && session_.clock() != "lockstep")
    controllers_.settle(session_.status());
  return true;
}

// While the world stands. Notes which controllers have left.
void Run::note_members() {
  controllers_.settle(session_.status());
  members_ = static_cast<std::uint32_t>(session_.status().lockstep.size());
}

// Waits for what the controllers send for the next tick before it acts; otherwise the order would depend on
// which program was faster.
void Run::act() {
  const auto due = timeline_->due(now_);
  if (!due.empty() && session_.clock() == "lockstep") controllers_.settle(session_.status());
  for (const TimelineEntry* entry : due) actions_->perform(*entry);
}

bool Run::is_over() {
  const double now_s = sim_seconds(now_);
  if (!settled_at_s_) {
    const Until& until = scenario_.until;
    const bool last = now_s >= scenario_.max_sim_s - kRounding_s;
    if (last && until.kind == Until::Kind::kControllers) note_members();
    const bool reached = until.kind == Until::Kind::kControllers ? controllers_.all_done()
                         : until.kind == Until::Kind::kTime
                             ? now_s >= until.at_s - kRounding_s
                             : holds(until.condition->bounds, until_->measure(*until_, now_));
    if (reached) settled_at_s_ = now_s;
  }
  if (settled_at_s_ && now_s >= *settled_at_s_ + scenario_.settle_s - kRounding_s) return true;
  return now_s >= scenario_.max_sim_s - kRounding_s;
}

void Run::note_unfinished() {
  if (!settled_at_s_) {
    const char* what = scenario_.until.kind == Until::Kind::kControllers ? "the controllers have not ended"
                       : scenario_.until.kind == Until::Kind::kTime ? "the time of 'until' was not reached"
                                                                    : "the condition of 'until' never held";
    report_.failures.push_back(std::string(what) + " within max_sim_s, " + cli::exact(scenario_.max_sim_s) +
                               " s");
  }
  for (const TimelineEntry* entry : timeline_->missed()) {
    report_.failures.push_back(config::ConfigError(entry->place, "this entry never came due").what());
  }
}

void Run::look_back() {
  last_ = session_.status();
  report_.limited_ticks = last_.limited_ticks;
  report_.limited_bodies = last_.limited_bodies;
  report_.tripped = session_.tripped(catalogue_);
}

// We step this world, so we also pace its real time. After a delay it does not catch up in a burst.
void Run::pace() {
  const auto step =
      std::chrono::duration_cast<Clock::duration>(std::chrono::nanoseconds(step_ticks_ * session_.tick_ns()));
  due_ = std::max(due_ + step, Clock::now() - step);
  const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(due_ - Clock::now());
  if (left.count() > 0) wait_loop_.wait(-1, left);
}

void Run::keep() {
  if (!options_.keep) return;
  options_.on_keep(report_, daemon_.port(), catalogue_);
  wait_loop_.lift_limit();
  while (true) {
    pace();
    session_.send_steps(1, step_ticks_, {}, 0);
    session_.take_step();
    announcements_.flush(session_);  // the last lines of controllers
  }
}

// Runs `work`; what it throws becomes the report's error.
void guard(Report& report, Daemon* daemon, auto&& work) {
  try {
    work();
  } catch (const cli::ExitError& error) {
    fail(report, error.code(), error.what());
  } catch (const config::ConfigError& error) {
    fail(report, cli::kBadConfig, error.what());
  } catch (const protocol::ConnectionError& error) {
    const std::string obituary = daemon != nullptr ? daemon->obituary() : std::string();
    const bool hung = !obituary.empty() && daemon->process().check_exit()->number == cli::kTimedOut;
    fail(report, hung ? cli::kTimedOut : cli::kInvalid, obituary.empty() ? error.what() : obituary);
  } catch (const protocol::RequestError& error) {
    fail(report, cli::kFailed, std::string("visumd refused: ") + error.what());
  }
}

void Run::collect() {
  report_.wall_seconds = seconds_since(began_);
  report_.ticks = now_.world.tick;
  report_.sim_seconds = sim_seconds(now_);
  report_.state_hash = now_.world.state_hash;
  for (const Check& check : checks_) report_.checks.push_back(check.result());
  news_.finish(report_.checks);
  Report of_events;  // a daemon that is gone is told elsewhere
  guard(of_events, nullptr, [this] { announcements_.flush(session_); });
  controllers_.stop_all();
  report_.controllers = controllers_.results();
}

void run_with(Daemon& daemon, const Scenario& scenario, const RunOptions& options, WaitLoop& wait_loop,
              Report& report) {
  std::optional<Run> run;
  guard(report, &daemon, [&] {
    run.emplace(scenario, options, daemon, wait_loop, report);
    run->go();
  });
  if (options.profile != nullptr) options.profile->runner().enter(config::Profile::kEnd);
  if (!run) return;
  std::string invalid;
  Report at_the_end;  // if the daemon is gone, the report says so already
  guard(at_the_end, nullptr, [&] {
    run->look_back();
    invalid = run->why_invalid();
  });
  run->collect();
  judge(report);
  if (invalid.empty()) invalid = run->out_of_step();
  // A controller that failed explains the run by itself.
  const bool all_well =
      std::ranges::all_of(report.controllers, [](const auto& c) { return c.failure.empty(); });
  if (invalid.empty() && all_well && at_the_end.code == cli::kDone) invalid = run->silent_controller();
  if (!invalid.empty()) invalidate(report, invalid);
  constexpr cli::ExitCode kWithAWorld[] = {cli::kDone, cli::kFailed, cli::kInvalid, cli::kLost};
  if (std::ranges::find(kWithAWorld, report.code) != std::end(kWithAWorld)) {
    Report afterwards;  // how the time after the scenario ends does not matter to its result
    guard(afterwards, &daemon, [&] { run->keep(); });
  }
  Report ended;  // a server that is gone already has ended, too
  guard(ended, nullptr, [&] { run->end_world(); });
}

// visumd's log says why a recording cannot be written, or ends early. Returns the reason, if this is such a
// line: "ends early: No space left on device".
std::string find_recording_trouble(const std::string& line, const std::string& recording) {
  const std::string subject = "the recording '" + recording + "' ";
  const auto at = line.find(subject);
  return recording.empty() || at == std::string::npos ? std::string() : line.substr(at + subject.size());
}

// A recording that was asked for belongs to the run's result; any other does not.
void note_recording(Report& report, const Scenario& scenario) {
  if (report.recording_trouble.empty() || scenario.record_if_possible) return;
  report.failures.push_back("the recording " + report.recording_trouble);
  if (report.code == cli::kDone) report.code = cli::kFailed;
}

}  // namespace

Report run_scenario(const Scenario& scenario, const RunOptions& options) {
  Report report;
  report.name = scenario.name;
  report.file = scenario.file.string();
  report.scene = scenario.scene.string();
  report.clock = scenario.clock;
  report.engine = scenario.engine.value_or("");
  report.seed = scenario.seed.value_or(-1);
  report.run = scenario.run;
  report.swept = scenario.swept;
  report.recording = scenario.record;
  WaitLoop wait_loop(scenario.max_wall_s);
  guard(report, nullptr, [&] {
    const cli::TempFolder links;
    DaemonOptions daemon_options{options.visumd,
                                 scenario.scene,
                                 scenario.clock,
                                 options.port,
                                 scenario.engine,
                                 scenario.seed,
                                 bus_options(scenario, links),
                                 scenario.record,
                                 scenario.record_if_possible,
                                 scenario.parameters,
                                 options.plugins,
                                 options.node_timeout_s};
    daemon_options.speedup = scenario.speedup;
    // Nobody could find the page of a run that does not say where it is.
    daemon_options.serves_page = options.keep || options.port != 0;
    if (options.notes_files) daemon_options.used_files = (links.path() / "files").string();
    daemon_options.caches = options.caches;
    daemon_options.threads = options.threads;
    daemon_options.forks = options.forks;
    if (options.profile != nullptr) {
      daemon_options.profile = options.profile->daemon_file().string();
      daemon_options.profile_spans = options.profile->wants_spans();
      daemon_options.on_end = [&](double processor_s) { options.profile->daemon_ended(processor_s); };
    }
    Daemon daemon(daemon_options, scenario.start_wall_s, wait_loop, [&](const std::string& line) {
      options.on_line("visumd", line);
      if (auto trouble = find_recording_trouble(line, scenario.record); !trouble.empty())
        report.recording_trouble = std::move(trouble);
    });
    if (options.notes_files) report.files = read_used_files(daemon_options.used_files);
    // With --keep the user wants to look at the world, from the beginning.
    if (options.keep && daemon.page_port() != 0)
      options.on_line("visumd", "the page: http://127.0.0.1:" + std::to_string(daemon.page_port()) + "/");
    run_with(daemon, scenario, options, wait_loop, report);
  });
  if (report.error.empty()) note_recording(report, scenario);
  return report;
}

}  // namespace visum::run
