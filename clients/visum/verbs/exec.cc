#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include "clients/visum/common/exit_code.h"
#include "clients/visum/exec/bus_of.h"
#include "clients/visum/exec/device_place.h"
#include "clients/visum/exec/tty_library.h"
#include "clients/visum/run/daemon.h"
#include "clients/visum/verbs/verbs.h"

namespace visum::cli {
namespace {

namespace fs = std::filesystem;

constexpr int kNotExecutable = 126, kNotFound = 127;  // as shells and env(1) have it

// "ttyS0=arm" or "/dev/ttyS0=arm": the device, then the part.
std::pair<std::string, std::string> split_tty(const std::string& text) {
  const auto equals = text.rfind('=');
  if (equals == std::string::npos || equals == 0 || equals + 1 == text.size())
    throw ExitError(kUsage, "--tty " + text + ": must be DEVICE=PART, as ttyS0=arm");
  const fs::path device = fs::path("/dev") / text.substr(0, equals);  // an absolute path replaces /dev
  if (device.parent_path() != "/dev" || device.filename().empty())
    throw ExitError(kUsage, "--tty " + text + ": the device must be in /dev itself");
  return {device, text.substr(equals + 1)};
}

class ExecVerb : public Verb {
 public:
  void declare(CLI::App& app) override {
    add_link_options(app, link_, false);
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
    app.add_option("COMMAND", command_, "the program and its arguments, after --")->required();
    app.footer(
        "Runs a program that knows nothing of Visum with a part's field bus where it looks for its device.\n"
        "visum becomes the program: signals and the exit code are the program's own. 126, 127: it cannot be "
        "run, is not found.\n\nExample:\n"
        "  visumd models/scenes/amtec_arm.yaml --bus arm=pty:arm.tty &\n"
        "  visum exec --tty ttyS0=arm -- ./controller args\n"
        "  visum exec --can esd -- ./controller          where visumd has --bus arm=tcp:0");
  }

  int run() override {
    if (ttys_.empty() && cans_.empty())
      throw ExitError(kUsage, "nothing to put in its place: --tty DEVICE=PART or --can VENDOR is missing");
    if (cans_.size() > 1) throw ExitError(kUsage, "--can: there is one CAN bus for a program");
    std::vector<std::pair<std::string, std::string>> ttys;
    for (const auto& text : ttys_) ttys.push_back(split_tty(text));
    const auto status =
        open_link(link_, protocol::Role::kObserver).request_as<protocol::ServerStatus>(protocol::Status{});
    if (!cans_.empty()) lead_can(cans_.front(), status);
    if (!ttys.empty()) {
      const auto devices = placements(ttys, status);
      exec::load_tty_library(devices);
      exec::place_devices(devices);
    }
    return become();
  }

 private:
  static std::vector<exec::Placement> placements(const std::vector<std::pair<std::string, std::string>>& ttys,
                                                 const protocol::ServerStatus& status) {
    std::vector<exec::Placement> all;
    for (const auto& [device, part] : ttys) {
      const auto path = exec::bus_of(status.buses, part, "pty");
      std::error_code error;
      const auto real = fs::canonical(path, error);
      if (error)
        throw ExitError(kFailed, path + ": " + error.message() + "; the server must run on this machine");
      all.push_back({device, real});
    }
    return all;
  }

  // The program's own library of that vendor is found in our folder first, and knows from the environment
  // where the bus is. Buses are on the server's loopback, and so must the program be.
  static void lead_can(const std::string& text, const protocol::ServerStatus& status) {
    const auto equals = text.find('=');
    const auto vendor = text.substr(0, equals);
    const auto part = equals == std::string::npos ? std::string() : text.substr(equals + 1);
    if (vendor != "esd" && vendor != "peak")
      throw ExitError(kUsage, "--can " + text + ": must be esd or peak");
    const auto folder = run::own_folder().parent_path() / "lib" / "visum-can";
    const auto library = folder / (vendor == "esd" ? "libntcan.so" : "libpcan.so");
    if (!fs::exists(library)) throw ExitError(kFailed, "there is no " + library.string());
    const char* others = std::getenv("LD_LIBRARY_PATH");
    const auto path = folder.string() + (others && *others ? ":" + std::string(others) : "");
    ::setenv("LD_LIBRARY_PATH", path.c_str(), 1);
    ::setenv("VISUM_CAN", ("127.0.0.1:" + exec::bus_of(status.buses, part, "tcp")).c_str(), 1);
  }

  int become() {
    std::vector<char*> argv;
    for (auto& word : command_) argv.push_back(word.data());
    argv.push_back(nullptr);
    std::signal(SIGPIPE, SIG_DFL);
    ::execvp(argv[0], argv.data());
    const int error = errno;
    throw ExitError(static_cast<ExitCode>(error == ENOENT ? kNotFound : kNotExecutable),
                    "cannot run '" + command_.front() + "': " + std::strerror(error));
  }

  LinkOptions link_;
  std::vector<std::string> ttys_, cans_;
  std::vector<std::string> command_;
};

}  // namespace

std::unique_ptr<Verb> make_exec() {
  return std::make_unique<ExecVerb>();
}

}  // namespace visum::cli
