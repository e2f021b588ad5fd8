#include "clients/visum/run/controllers.h"

#include <algorithm>
#include <chrono>
#include <csignal>

#include "clients/visum/common/exit_code.h"
#include "clients/visum/common/format.h"
#include "clients/visum/run/daemon.h"
#include "clients/visum/run/placeholders.h"

namespace visum::run {
namespace {

using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

constexpr milliseconds kPatienceAtEnd{2000};     // after SIGINT
constexpr milliseconds kPatienceToLeave{10000};  // from leaving the lockstep to the end of the process

const protocol::LockstepMember* find_member(const protocol::ServerStatus& status, const std::string& client) {
  const auto found =
      std::find_if(status.lockstep.begin(), status.lockstep.end(),
                   [&](const protocol::LockstepMember& member) { return member.client == client; });
  return found == status.lockstep.end() ? nullptr : &*found;
}

// The command of `visum exec` that keeps a program in step if it knows nothing of a clock; empty: it needs
// none.
std::vector<std::string> scheduler_of(const ControllerSpec& spec, const std::string& connect) {
  if (!spec.shim && spec.gate.empty()) return {};
  std::vector<std::string> argv{(own_folder() / "visum").string(), "exec", "--name", spec.client};
  if (spec.shim)
    argv.push_back("--lockstep");
  else
    argv.insert(argv.end(), {"--gate", spec.gate});
  if (spec.period_ms > 0.0) argv.insert(argv.end(), {"--period", cli::exact(spec.period_ms)});
  if (spec.wait_s > 0.0) argv.insert(argv.end(), {"--wait", cli::exact(spec.wait_s)});
  argv.insert(argv.end(), {"--on-timeout", spec.on_timeout, "--connect", connect, "--"});
  return argv;
}

}  // namespace

Controllers::Controllers(const std::vector<ControllerSpec>& specs,
                         const std::map<std::string, std::string>& values, Session& session,
                         WaitLoop& wait_loop, OnLine on_line)
    : values_(values), session_(session), wait_loop_(wait_loop), on_line_(std::move(on_line)) {
  for (const ControllerSpec& spec : specs) {
    Controller controller;
    controller.spec = &spec;
    controller.joins = spec.joins.value_or(session.clock() == "lockstep");
    controllers_.push_back(std::move(controller));
  }
}

Controllers::~Controllers() {
  stop_all();
  for (Controller& controller : controllers_) {
    if (controller.process) wait_loop_.forget(*controller.process);
  }
}

void Controllers::start(double patience_s) {
  for (Controller& controller : controllers_) start_one(controller);
  await_joined(patience_s);
}

void Controllers::start_one(Controller& controller) {
  auto argv = session_.clock() == "lockstep" ? scheduler_of(*controller.spec, values_.at("connect"))
                                             : std::vector<std::string>();
  for (const std::string& word : controller.spec->command) argv.push_back(fill_in(word, values_));
  const auto hand_on = [this, spec = controller.spec](const std::string& line) {
    on_line_(spec->name, line);
  };
  try {
    controller.process =
        std::make_unique<processes::ChildProcess>(controller.spec->name, argv, hand_on, hand_on);
  } catch (const std::runtime_error& error) {
    throw config::ConfigError(controller.spec->place, error.what());
  }
  wait_loop_.watch(*controller.process);
}

void Controllers::await_joined(double patience_s) {
  const auto give_up = Clock::now() + std::chrono::duration<double>(patience_s);
  for (;;) {
    const auto status = session_.status();
    std::string missing;
    for (Controller& controller : controllers_) {
      controller.joined = controller.joined || find_member(status, controller.spec->client) != nullptr;
      if (!controller.joins || controller.joined) continue;
      missing = controller.spec->name;
      if (const auto& exit = controller.process->check_exit()) {
        throw cli::ExitError(exit->by_signal ? cli::kLost : cli::kFailed,
                             "controller '" + missing + "' " + exit->text() + " before it joined the clock");
      }
    }
    if (missing.empty()) return;
    if (Clock::now() > give_up) {
      throw cli::ExitError(cli::kLost, "controller '" + missing + "' has not joined the clock within " +
                                           cli::exact(patience_s) + " s");
    }
    wait_loop_.wait(-1, milliseconds(1));
  }
}

bool Controllers::is_undecided(const protocol::ServerStatus& status) const {
  return std::any_of(controllers_.begin(), controllers_.end(), [&](const Controller& controller) {
    if (!controller.joined || controller.left) return false;
    const auto* member = find_member(status, controller.spec->client);
    return member != nullptr && member->granted_tick <= status.tick;
  });
}

void Controllers::note_who_left(const protocol::ServerStatus& status) {
  note_timeouts();
  for (Controller& controller : controllers_) {
    const bool is_member = find_member(status, controller.spec->client) != nullptr;
    if (!controller.joined || controller.left || is_member) continue;
    controller.left = true;
    await_exit(controller);
    // Programs behind it have nobody left to work for. If the world went on while they end, its last tick
    // would depend on how long that takes.
    for (Controller& behind : controllers_) {
      if (behind.spec->through == controller.spec->name && !behind.joined) await_exit(behind);
    }
  }
}

// Waits, while the world stands, until the process has ended and the server has seen the end of its
// connection.
void Controllers::await_exit(Controller& controller) {
  const auto give_up = Clock::now() + kPatienceToLeave;
  while (!controller.process->check_exit() || find_member(session_.status(), controller.spec->client)) {
    if (Clock::now() > give_up) {
      throw cli::ExitError(cli::kLost, "controller '" + controller.spec->name + "' did not end after " +
                                           (controller.joined ? "it" : "'" + controller.spec->through + "'") +
                                           " had left the clock");
    }
    // The world stands meanwhile, so a program's end is not waited for by the millisecond.
    const auto& process = *controller.process;
    wait_loop_.wait(process.exit() ? -1 : process.exit_fd(), milliseconds(1));
  }
  check_ends();
}

// The members' own work takes the time here. So it asks without a pause at first, for members that are quick.
void Controllers::settle(protocol::ServerStatus status) {
  for (int tries = 0; session_.clock() == "lockstep" && is_undecided(status); ++tries) {
    if (tries > 20) wait_loop_.wait(-1, milliseconds(1));
    status = session_.status();
  }
  note_who_left(status);
}

void Controllers::note_timeouts() {
  for (const std::string& why : session_.take_timeouts()) {
    const auto late = std::ranges::find_if(controllers_, [&](const Controller& controller) {
      return controller.joined && why.starts_with("'" + controller.spec->client + "' ");
    });
    if (late == controllers_.end() || late->spec->on_timeout == "end") throw cli::ExitError(cli::kLost, why);
    late->joined = false;
    if (late->spec->on_timeout == "stop")
      late->lost = why;
    else
      late->let_go = true;
    on_line_("scenario", why + (late->let_go ? ": it goes on in real time" : ": its parts are stopped"));
  }
}

bool Controllers::all_joined() const {
  return std::ranges::all_of(controllers_, [](const Controller& controller) { return controller.joined; });
}

bool Controllers::any_in_real_time() const {
  return std::ranges::any_of(controllers_, [](const Controller& controller) {
    return controller.let_go && !controller.process->check_exit();
  });
}

bool Controllers::all_done() const {
  return std::all_of(controllers_.begin(), controllers_.end(), [](const Controller& controller) {
    return controller.joined ? controller.left : controller.process->check_exit().has_value();
  });
}

void Controllers::check_ends() {
  for (const Controller& controller : controllers_) {
    const std::string failure = failure_of(controller);
    if (failure.empty() || !controller.lost.empty()) continue;  // those were late before; the others go on
    const bool by_signal = controller.process->check_exit()->by_signal;
    throw cli::ExitError(by_signal ? cli::kLost : cli::kFailed,
                         "controller '" + controller.spec->name + "' " + failure);
  }
}

std::string Controllers::failure_of(const Controller& controller) const {
  if (!controller.lost.empty()) return controller.lost;
  if (!controller.process || controller.signalled || controller.stopped) return {};
  const auto& exit = controller.process->check_exit();
  return exit && (exit->by_signal || exit->number != 0) ? exit->text() : std::string();
}

// After SIGKILL it waits until the process is gone and the server has seen it, so that every run goes on in
// the same way.
void Controllers::signal(const std::string& name, int number) {
  for (Controller& controller : controllers_) {
    if (controller.spec->name != name || !controller.process) continue;
    controller.signalled = true;
    controller.process->signal(number);
    if (number != SIGKILL) continue;
    await_exit(controller);
    controller.left = true;
  }
}

void Controllers::stop_all() {
  for (Controller& controller : controllers_) {
    if (!controller.process || controller.process->check_exit()) continue;
    controller.stopped = true;
    controller.process->signal(SIGINT);
  }
  const auto give_up = Clock::now() + kPatienceAtEnd;
  for (Controller& controller : controllers_) {
    if (!controller.process) continue;
    const auto left = std::chrono::duration_cast<milliseconds>(give_up - Clock::now());
    if (!controller.process->wait_exit(std::max(left, milliseconds(0))))
      controller.process->stop(milliseconds(0));
  }
}

std::string Controllers::out_of_step() const {
  constexpr std::string_view kVerdict = "visum: INVALID: ";
  for (const Controller& controller : controllers_) {
    if (!controller.spec->shim || !controller.process) continue;
    for (const std::string& line : controller.process->last_lines())
      if (line.starts_with(kVerdict))
        return "controller '" + controller.spec->name + "': " + line.substr(kVerdict.size());
  }
  return {};
}

std::vector<ControllerResult> Controllers::results() const {
  std::vector<ControllerResult> results;
  for (const Controller& controller : controllers_) {
    ControllerResult result{controller.spec->name, "was not started", failure_of(controller), {}};
    if (controller.process) {
      const auto& lines = controller.process->last_lines();
      result.last_lines.assign(lines.begin(), lines.end());
      const auto& exit = controller.process->check_exit();
      result.lost = !controller.lost.empty() || (exit && exit->by_signal);
      result.end = controller.stopped ? "was stopped at the end" : exit ? exit->text() : "still runs";
    }
    results.push_back(std::move(result));
  }
  return results;
}

}  // namespace visum::run
