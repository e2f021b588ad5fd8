#include <sys/wait.h>

#include <cerrno>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <map>
#include <optional>

#include "clients/visum/common/exit_code.h"
#include "clients/visum/common/format.h"
#include "clients/visum/common/json_writer.h"
#include "clients/visum/common/temp_folder.h"
#include "clients/visum/exec/bus_options.h"
#include "clients/visum/exec/launch.h"
#include "clients/visum/exec/lockstep.h"
#include "clients/visum/exec/tty_library.h"
#include "clients/visum/run/daemon.h"
#include "clients/visum/verbs/verbs.h"

namespace visum::cli {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr double kStart_s = 30.0;   // for a daemon of our own
constexpr double kForever_s = 1e8;  // about three years
constexpr double kLongest_s = 1e7;  // of --timeout

const char* const kFooter =
    "Runs a program that knows nothing of Visum with a part's field bus where it looks for its device.\n"
    "The exit code is the program's own; 126, 127: it cannot be run, is not found; 125: visum itself "
    "failed.\n"
    "Without --lockstep, --scene, --timeout and --json visum becomes the program, and signals are its own "
    "too.\n\n"
    "--lockstep: the program's clocks, sleeps and time-outs are the world's: it runs as fast as both can "
    "compute,\n"
    "and with the same result every time. 4: it was ended by a signal, or the world was lost; 124: "
    "--timeout.\n\n"
    "Example:\n"
    "  visumd models/scenes/amtec_arm.yaml --bus arm=pty:arm.tty &\n"
    "  visum exec --tty ttyS0=arm -- ./controller args\n"
    "  visum exec --can esd -- ./controller          where visumd has --bus arm=tcp:0\n"
    "  visum exec --scene models/scenes/amtec_arm.yaml --bus arm=pty --lockstep --json -- ./controller "
    "{bus.arm}";

void replace_all(std::string& text, const std::string& what, const std::string& with) {
  for (auto at = text.find(what); at != std::string::npos; at = text.find(what, at + with.size()))
    text.replace(at, what.size(), with);
}

class ExecVerb : public Verb {
 public:
  void declare(CLI::App& app) override {
    add_link_options(app, link_);
    app.add_option("--scene", scene_, "start a server of its own with this scene, on free ports")
        ->type_name("SCENE.yaml")
        ->excludes("--connect");
    app.add_option("--tty", ttys_,
                   "DEVICE=PART: the part's modules stand where the program opens /dev/DEVICE")
        ->type_name("DEVICE=PART")
        ->allow_extra_args(false);
    app.add_option(
           "--can", cans_,
           "esd or peak, then =PART where several have a bus: the vendor's CAN library leads to the part's "
           "modules")
        ->type_name("VENDOR[=PART]")
        ->allow_extra_args(false);
    app.add_option("--bus", buses_,
                   "with --scene: PART=pty or PART=tcp gives the part a bus; {bus.PART} in the command is "
                   "its path, or "
                   "its HOST:PORT")
        ->type_name("PART=KIND")
        ->allow_extra_args(false);
    app.add_option("--name", name_, "the program's name in `visum status`; the command's by default");
    app.add_flag("--lockstep", lockstep_, "the program's time is the world's");
    app.add_option("--timeout", timeout_s_,
                   "end the program after so many seconds of wall time, with exit code 124")
        ->check(number_within(1e-3, kLongest_s));
    app.add_option("COMMAND", command_, "the program and its arguments, after --")->required();
    app.footer(kFooter);
  }

  int run() override try {
    read_options();
    std::optional<TempFolder> links;
    run::Vigil vigil(kForever_s);
    std::optional<run::Daemon> daemon;
    if (!scene_.empty()) {
      links.emplace();
      daemon.emplace(daemon_options(*links), kStart_s, vigil, [](const std::string&) {});
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
  bool stays() const { return lockstep_ || !scene_.empty() || timeout_s_ > 0.0 || link_.json; }

  void read_options() {
    if (ttys_.empty() && cans_.empty() && !stays())
      throw ExitError(kUsage, "nothing to put in its place: --tty DEVICE=PART or --can VENDOR is missing");
    if (cans_.size() > 1) throw ExitError(kUsage, "--can: there is one CAN bus for a program");
    if (!buses_.empty() && scene_.empty()) throw ExitError(kUsage, "--bus: only with --scene");
    for (const auto& text : ttys_) parsed_ttys_.push_back(exec::parse_tty(text));
    for (const auto& text : cans_) parsed_cans_.push_back(exec::parse_can(text));
  }

  run::DaemonOptions daemon_options(const TempFolder& links) const {
    run::DaemonOptions options;
    options.program = run::find_visumd();
    options.scene = scene_;
    options.clock = lockstep_ ? "lockstep" : "realtime";
    const auto pty = [&](const std::string& part) {
      return part + "=pty:" + (links.path() / (part + ".tty")).string();
    };
    for (const auto& tty : parsed_ttys_) options.buses.push_back(pty(tty.part));
    for (const auto& can : parsed_cans_)
      if (!can.part.empty()) options.buses.push_back(can.part + "=tcp:0");
    for (const auto& text : buses_) {
      const auto part = text.substr(0, text.find('='));
      if (text == part + "=tcp")
        options.buses.push_back(part + "=tcp:0");
      else if (text == part + "=pty")
        options.buses.push_back(pty(part));
      else
        throw ExitError(kUsage, "--bus " + text + ": must be PART=pty or PART=tcp");
    }
    return options;
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
    const auto buses = link.request_as<protocol::ServerStatus>(protocol::Status{}).buses;
    for (const auto& can : parsed_cans_) exec::lead_can(can, buses);
    const auto devices = exec::placements_of(parsed_ttys_, buses);
    if (lockstep_) return run_in_lockstep(std::move(link), devices);
    if (!devices.empty()) exec::load_tty_library(devices);
    if (stays()) return run_beside(link, devices);
    if (!devices.empty()) exec::place_devices(devices);
    return exec::become(command_);
  }

  int run_in_lockstep(protocol::Connection link, const std::vector<exec::Placement>& devices) {
    exec::LockstepPlan plan{
        command_, devices, protocol::parse_address(link_.connect).second, {0, 2, protocol::OnTimeout::kEnd}};
    if (timeout_s_ > 0.0) plan.give_up = Clock::now() + duration();
    began_ = true;
    const auto end = exec::run_in_lockstep(std::move(link), plan);
    return finish(end.status, end.world);
  }

  // In real time.
  int run_beside(protocol::Connection& link, const std::vector<exec::Placement>& devices) {
    const pid_t program = exec::launch(command_, devices);
    began_ = true;
    const auto give_up = timeout_s_ > 0.0 ? Clock::now() + duration() : Clock::time_point::max();
    const int status = exec::await_end(program, give_up);
    return finish(status, link.request_as<protocol::ServerStatus>(protocol::Status{}));
  }

  Clock::duration duration() const {
    return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(timeout_s_));
  }

  int finish(int status, const protocol::ServerStatus& world) {
    const int code = exec::exit_code_of(status, command_.front());
    if (!link_.json) return code;
    JsonWriter json;
    json.begin_object().member("exit_code", code).member("ticks", world.tick);
    json.member("sim_seconds", static_cast<double>(world.sim_time_ns) * 1e-9);
    json.member("wall_seconds", std::chrono::duration<double>(Clock::now() - started_).count());
    json.member("state_hash", hex(world.state_hash)).end_object();
    std::printf("%s\n", json.text().c_str());
    return code;
  }

  LinkOptions link_;
  std::string scene_, name_;
  std::vector<std::string> ttys_, cans_, buses_;
  std::vector<exec::TtyOption> parsed_ttys_;
  std::vector<exec::CanOption> parsed_cans_;
  std::vector<std::string> command_;
  bool lockstep_ = false;
  double timeout_s_ = 0.0;
  bool began_ = false;  // the program
  Clock::time_point started_ = Clock::now();
};

}  // namespace

std::unique_ptr<Verb> make_exec() {
  return std::make_unique<ExecVerb>();
}

}  // namespace visum::cli
