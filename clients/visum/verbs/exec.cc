#include <sys/wait.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "clients/visum/common/exit_code.h"
#include "clients/visum/common/format.h"
#include "clients/visum/common/json_writer.h"
#include "clients/visum/common/temp_folder.h"
#include "clients/visum/exec/bus_options.h"
#include "clients/visum/exec/gate_option.h"
#include "clients/visum/exec/launch.h"
#include "clients/visum/exec/lockstep.h"
#include "clients/visum/exec/tty_library.h"
#include "clients/visum/run/daemon.h"
#include "clients/visum/run/overruns.h"
#include "clients/visum/verbs/verbs.h"
#include "protocol/command_line/one_of.h"

namespace visum::cli {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr double kStart_s = 30.0;   // for a daemon of our own
constexpr double kForever_s = 1e8;  // about three years
constexpr double kLongest_s = 1e7;  // of --timeout
constexpr double kLongestPeriod_ms = 1e6;

const char* const kFooter =
    "Runs a program that knows nothing of Visum, with a part's field bus in place of its device. Without "
    "--lockstep, "
    "--gate, --scene, --timeout and --json, visum itself becomes the program, so signals reach it directly.\n"
    "The grade says how it keeps in step with the world; `visum status` shows it. L0, without an option: "
    "both run in "
    "real time. L1, --gate: in real time, but the world runs by one period for each cycle of the program. "
    "L2, "
    "--lockstep: its clocks, sleeps and time-outs are the world's, as fast as both can compute. With L1 and "
    "L2 every "
    "run has the same result.\n"
    "Exit codes: that of the program, or 2 wrong options, 3 the scene is wrong, 4 with L1 or L2 the program "
    "was ended by a signal or was late (--wait) or the world was lost, 6 the run is invalid: its claim could "
    "not be established (with L0 the host was too slow for real time; with L2 a process of the program did "
    "not keep in step, as one that is linked statically), 124 --timeout is over, 125 visum itself failed, "
    "126 "
    "the program cannot be run, 127 it was not found.\n"
    "\nExamples:\n"
    "  visumd models/scenes/amtec_arm.yaml --bus arm=pty:arm.tty &\n"
    "  visum exec --tty ttyS0=arm -- ./controller args\n"
    "  visum exec --can esd -- ./controller          with visumd's --bus arm=tcp:0\n"
    "  visum exec --scene models/scenes/amtec_arm.yaml --bus arm=pty --lockstep \\\n"
    "    --json -- ./controller {bus.arm}\n"
    "  visum exec --scene models/scenes/amtec_arm.yaml --bus arm=pty --period 20 \\\n"
    "    --gate bus:arm -- ./controller {bus.arm}";

void replace_all(std::string& text, const std::string& what, const std::string& with) {
  for (auto at = text.find(what); at != std::string::npos; at = text.find(what, at + with.size()))
    text.replace(at, what.size(), with);
}

class ExecVerb : public Verb {
 public:
  void declare(CLI::App& app) override {
    add_link_options(app, link_);
    app.add_option("--scene", scene_, "start a server of its own with this scene, on free ports")
        ->type_name("SCENE.yaml");
    app.add_flag("--no-cache", no_cache_,
                 "with --scene: neither use nor keep converted meshes of earlier runs");
    app_ = &app;
    app.add_option("--tty", ttys_,
                   "the program finds the part's modules where it opens /dev/DEVICE; repeatable")
        ->type_name("DEVICE=PART")
        ->allow_extra_args(false);
    app.add_option("--can", cans_,
                   "the vendor's CAN library, esd or peak, leads to the part's modules; =PART is needed if "
                   "several parts have a bus")
        ->type_name("VENDOR[=PART]")
        ->allow_extra_args(false);
    app.add_option("--bus", buses_,
                   "with --scene: PART=pty, PART=slcan or PART=tcp gives the part a bus; {bus.PART} in the "
                   "command stands for its path or HOST:PORT")
        ->type_name("PART=KIND")
        ->allow_extra_args(false);
    app.add_option("--name", name_, "the program's name in `visum status`; default: the command's");
    declare_step(app);
    declare_pace(app);
    app.add_option("--timeout", timeout_s_,
                   "end the program after this many seconds of wall time, with exit code 124")
        ->check(number_within(1e-3, kLongest_s));
    app.add_option("COMMAND", command_, "the program and its arguments, after --")->required();
    app.footer(kFooter);
  }

  int run() override try {
    read_options();
    std::optional<TempFolder> links;
    run::WaitLoop wait_loop(kForever_s);
    std::optional<run::Daemon> daemon;
    if (!scene_.empty()) {
      links.emplace();
      start(daemon, daemon_options(*links), wait_loop);
      link_.connect = "127.0.0.1:" + std::to_string(daemon->port());
      fill_in_places(*daemon);
    }
    return run_there();
  } catch (const ExitError& error) {
    if (error.code() == kUsage || error.code() == kBadConfig || began_) throw;
    throw ExitError(kExecFailed, error.what());
  } catch (const protocol::ConnectionError& error) {
    throw ExitError(began_ ? kLost : kExecFailed, error.what());
  } catch (const std::runtime_error& error) {
    throw ExitError(kExecFailed, error.what());
  }

 private:
  // Options about keeping in step with the world.
  void declare_step(CLI::App& app) {
    auto* lockstep =
        app.add_flag("--lockstep", lockstep_, "give the program the world's time, by a time shim (L2)");
    app.add_option("--gate", gate_,
                   "for a program that asks and is answered: each of its cycles lets the world run by "
                   "--period (L1). WHAT says what ends a cycle: bus[:PART[=MODULE:BYTES]] or ports[:CLIENT]; "
                   "by default, a request that the cycle has seen before")
        ->type_name("WHAT")
        ->excludes(lockstep);
    app.add_option("--period", period_ms_,
                   "with --gate: simulated ms of a cycle, by default 10; with --lockstep: the program wakes "
                   "up only at multiples of it")
        ->type_name("MS")
        ->check(number_within(1e-3, kLongestPeriod_ms));
    app.add_option("--wait", wait_s_,
                   "with --gate and --lockstep: the seconds of wall time that the world waits for the "
                   "program. Default: the scene's lockstep_timeout_s, or without limit if no other client "
                   "steps with the world")
        ->type_name("S")
        ->check(number_within(1e-3, kLongest_s));
    app.add_option(
           "--on-timeout", on_timeout_,
           "what happens after --wait: end the run (exit code 4), hold the world, stop the part and the "
           "program (exit code 4) while others go on, or free the program, which goes on in real time")
        ->capture_default_str()
        ->check(command_line::one_of({"end", "hold", "stop", "free"}));
  }

  // Options about pace and how much lateness a run in real time may have.
  void declare_pace(CLI::App& app) {
    app.add_option("--speedup", speedup_,
                   "with --scene: simulated seconds per second of wall time; with --lockstep and --gate this "
                   "is the most, and without it they run as fast as they can")
        ->type_name("X")
        ->check(number_within(1e-3, 1e3));
    app.add_option("--max-overruns", max_overruns_,
                   "in real time: the share of ticks that may begin more than a tick late; with more the run "
                   "is invalid (exit code 6)")
        ->type_name("SHARE")
        ->check(number_within(0.0, 1.0))
        ->capture_default_str();
  }

  exec::Advice advice() const {
    return scene_.empty() ? exec::Advice::kServersOptions : exec::Advice::kOwnOptions;
  }
  bool in_step() const { return lockstep_ || parsed_gate_.has_value(); }
  bool stays() const { return in_step() || !scene_.empty() || timeout_s_ > 0.0 || link_.json; }

  // True if --connect stands on the command line. CLI11's excludes() would also count VISUM_CONNECT.
  bool has_said_connect() const {
    const auto& said = app_->parse_order();
    return std::ranges::find(said, app_->get_option("--connect")) != said.end();
  }

  void read_options() {
    if (!scene_.empty() && has_said_connect())
      throw ExitError(kUsage, "--scene starts a server of its own, so --connect cannot name another");
    if (!gate_.empty()) parsed_gate_ = exec::parse_gate(gate_);
    if (!in_step() && (period_ms_ > 0.0 || wait_s_ > 0.0 || on_timeout_ != "end"))
      throw ExitError(kUsage, "--period, --wait and --on-timeout: only with --lockstep or --gate");
    if (speedup_ > 0.0 && scene_.empty())
      throw ExitError(kUsage, "--speedup: only with --scene; a server that runs already has its own");
    if (no_cache_ && scene_.empty()) throw ExitError(kUsage, "--no-cache: only with --scene");
    if (ttys_.empty() && cans_.empty() && !stays())
      throw ExitError(kUsage, "no device to replace: give --tty DEVICE=PART or --can VENDOR");
    if (cans_.size() > 1) throw ExitError(kUsage, "--can: a program gets one CAN bus; give it once");
    if (!buses_.empty() && scene_.empty()) throw ExitError(kUsage, "--bus: only with --scene");
    for (const auto& text : ttys_) parsed_ttys_.push_back(exec::parse_tty(text));
    for (const auto& text : cans_) parsed_cans_.push_back(exec::parse_can(text));
    for (const auto& text : buses_) parsed_buses_.push_back(exec::parse_bus(text));
  }

  // visumd names a bus that it cannot have by the address that we gave it, of which the user knows nothing.
  static void start(std::optional<run::Daemon>& daemon, const run::DaemonOptions& options,
                    run::WaitLoop& wait_loop) try {
    daemon.emplace(options, kStart_s, wait_loop, [](const std::string&) {});
  } catch (const ExitError& error) {
    constexpr std::string_view kRefusal = "' is no bus: ";
    const std::string_view said = error.what();
    const auto at = said.find(kRefusal);
    if (at == said.npos) throw;
    throw ExitError(error.code(), "--bus, --tty or --can: " + std::string(said.substr(at + kRefusal.size())));
  }

  run::DaemonOptions daemon_options(const TempFolder& links) const {
    run::DaemonOptions options;
    options.program = run::find_visumd();
    options.scene = scene_;
    options.clock = in_step() ? "lockstep" : "realtime";
    options.speedup = speedup_;
    options.caches = !no_cache_;
    // The last one of a part is the one that {bus.PART} names.
    const auto add = [&](const std::string& bus) {
      std::erase(options.buses, bus);
      options.buses.push_back(bus);
    };
    for (const auto& tty : parsed_ttys_) add(exec::bus_address(tty.part, "pty", links.path()));
    for (const auto& can : parsed_cans_) add(exec::bus_address(part_to_add(can), "tcp", links.path()));
    for (const auto& [part, kind] : parsed_buses_) add(exec::bus_address(part, kind, links.path()));
    return options;
  }

  // The part of --can. Where it names none: the one that another option names, else the scene's only part
  // with modules, which visumd finds.
  std::string part_to_add(const exec::CanOption& can) const {
    if (!can.part.empty()) return can.part;
    const auto over_tcp = std::ranges::find(parsed_buses_, "tcp", &exec::BusOption::kind);
    if (over_tcp != parsed_buses_.end()) return over_tcp->part;
    if (!parsed_buses_.empty()) return parsed_buses_.front().part;
    return parsed_ttys_.empty() ? std::string() : parsed_ttys_.front().part;
  }

  void fill_in_places(const run::Daemon& daemon) {
    std::map<std::string, std::string> values{{"connect", link_.connect}};
    for (const auto& [part, place] : daemon.buses()) values["bus." + part] = place;
    for (auto& word : command_)
      for (const auto& [name, value] : values) replace_all(word, "{" + name + "}", value);
  }

  int run_there() {
    const auto name = name_.empty() ? fs::path(command_.front()).filename().string() : name_;
    auto link = open_link(link_, protocol::Role::kController, name);
    const auto world = link.request_as<protocol::ServerStatus>(protocol::Status{});
    const auto& buses = world.buses;
    for (const auto& can : parsed_cans_) exec::lead_can(can, buses, advice());
    const auto devices = exec::placements_of(parsed_ttys_, buses, advice());
    if (lockstep_) return run_in_step(std::move(link), devices, shim_join(buses));
    if (!devices.empty()) exec::load_tty_library(devices);
    if (parsed_gate_) return run_in_step(std::move(link), devices, gate_join(buses, name));
    if (stays()) return run_beside(link, devices, world);
    if (!devices.empty()) exec::place_devices(devices);
    return exec::become(command_);
  }

  protocol::Join shim_join(const std::vector<protocol::PartBus>& buses) const {
    static const std::map<std::string, protocol::OnTimeout> kWays{{"end", protocol::OnTimeout::kEnd},
                                                                  {"hold", protocol::OnTimeout::kHold},
                                                                  {"stop", protocol::OnTimeout::kStop},
                                                                  {"free", protocol::OnTimeout::kFree}};
    return {std::llround(wait_s_ * 1e9), 2, kWays.at(on_timeout_), {}, parts_of_bus(buses)};
  }

  protocol::Join gate_join(const std::vector<protocol::PartBus>& buses, const std::string& program) const {
    auto join = shim_join(buses);
    join.grade = 1;
    join.gate = exec::gate_of(*parsed_gate_, buses, program);
    join.gate->period_ns = period_ns();
    if (!join.gate->part.empty()) join.parts.push_back(join.gate->part);
    return join;
  }

  // The parts that the program commands by their buses, as far as the options name them.
  std::vector<std::string> parts_of_bus(const std::vector<protocol::PartBus>& buses) const {
    std::vector<std::string> parts;
    for (const auto& tty : parsed_ttys_) parts.push_back(tty.part);
    for (const auto& bus : parsed_buses_) parts.push_back(bus.part);
    for (const auto& can : parsed_cans_) parts.push_back(exec::part_of_can(can, buses));
    return parts;
  }

  int run_in_step(protocol::Connection link, const std::vector<exec::Placement>& devices,
                  const protocol::Join& join) {
    exec::LockstepPlan plan{command_, devices, protocol::parse_address(link_.connect).second, join,
                            period_ns()};
    if (period_ns() % link.welcome().tick_ns != 0)
      throw ExitError(kUsage, "--period must be whole ticks of this world, of " +
                                  exact(static_cast<double>(link.welcome().tick_ns) * 1e-6) + " ms");
    if (timeout_s_ > 0.0) plan.give_up = Clock::now() + duration();
    began_ = true;
    const auto end =
        lockstep_ ? exec::run_in_lockstep(std::move(link), plan) : exec::run_gated(std::move(link), plan);
    started_program_ = end.started;
    return finish(end.status, end.world, end.invalid);
  }

  // Runs the program in real time, and warns if the world keeps in step with others.
  int run_beside(protocol::Connection& link, const std::vector<exec::Placement>& devices,
                 const protocol::ServerStatus& before) {
    if (before.clock == "lockstep")
      std::fprintf(
          stderr,
          "visum: the world keeps in step with others, but not with '%s', which runs in real time (L0); "
          "--lockstep or --gate make it keep in step\n",
          command_.front().c_str());
    const pid_t program = exec::launch(command_, devices);
    began_ = true;
    const auto give_up = timeout_s_ > 0.0 ? Clock::now() + duration() : Clock::time_point::max();
    const int status = exec::await_end(program, give_up);
    started_program_ = exec::was_started();
    const auto after = link.request_as<protocol::ServerStatus>(protocol::Status{});
    return finish(status, after, run::why_invalid(before, after, max_overruns_));
  }

  std::int64_t period_ns() const { return std::llround(period_ms_ * 1e6); }

  Clock::duration duration() const {
    return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(timeout_s_));
  }

  int finish(int status, const protocol::ServerStatus& world, const std::string& invalid) {
    const int code = exec::exit_code_of(status, command_.front());
    if (!invalid.empty()) std::fprintf(stderr, "visum: INVALID: %s\n", invalid.c_str());
    if (link_.json) print_json(code, world, invalid);
    return invalid.empty() ? code : kInvalid;
  }

  void print_json(int code, const protocol::ServerStatus& world, const std::string& invalid) const {
    JsonWriter json;
    json.begin_object().member("exit_code", code).member("ticks", world.tick);
    json.member("grade", lockstep_      ? "L2"
                         : parsed_gate_ ? "L1"
                                        : "L0")
        .member("valid", invalid.empty() && started_program_);
    if (!invalid.empty()) json.member("invalid_reason", invalid);
    if (!started_program_) json.member("invalid_reason", "the program could not be started");
    json.member("sim_seconds", static_cast<double>(world.sim_time_ns) * 1e-9);
    json.member("wall_seconds", std::chrono::duration<double>(Clock::now() - started_).count());
    json.member("state_hash", hex(world.state_hash)).end_object();
    std::printf("%s\n", json.text().c_str());
  }

  const CLI::App* app_ = nullptr;
  LinkOptions link_;
  std::string scene_, name_, gate_, on_timeout_ = "end";
  std::optional<exec::GateOption> parsed_gate_;
  std::vector<std::string> ttys_, cans_, buses_;
  std::vector<exec::TtyOption> parsed_ttys_;
  std::vector<exec::CanOption> parsed_cans_;
  std::vector<exec::BusOption> parsed_buses_;
  std::vector<std::string> command_;
  bool lockstep_ = false;
  bool no_cache_ = false;
  double timeout_s_ = 0.0, period_ms_ = 0.0, wait_s_ = 0.0, speedup_ = 0.0;
  double max_overruns_ = run::kMostOverruns;
  bool began_ = false;  // the program
  bool started_program_ = true;
  Clock::time_point started_ = Clock::now();
};

}  // namespace

std::unique_ptr<Verb> make_exec() {
  return std::make_unique<ExecVerb>();
}

}  // namespace visum::cli
