#include "clients/visum/exec/bus_options.h"

#include <cstdlib>
#include <filesystem>

#include "clients/visum/common/exit_code.h"
#include "clients/visum/exec/bus_of.h"
#include "clients/visum/run/daemon.h"

namespace visum::exec {

namespace fs = std::filesystem;

TtyOption parse_tty(const std::string& text) {
  const auto equals = text.rfind('=');
  if (equals == std::string::npos || equals == 0 || equals + 1 == text.size())
    throw cli::ExitError(cli::kUsage, "--tty " + text + ": must be DEVICE=PART, as ttyS0=arm");
  const fs::path device = fs::path("/dev") / text.substr(0, equals);  // an absolute path replaces /dev
  if (device.parent_path() != "/dev" || device.filename().empty())
    throw cli::ExitError(cli::kUsage, "--tty " + text + ": the device must be in /dev itself");
  return {device, text.substr(equals + 1)};
}

CanOption parse_can(const std::string& text) {
  const auto equals = text.find('=');
  CanOption can{text.substr(0, equals),
                equals == std::string::npos ? std::string() : text.substr(equals + 1)};
  if (can.vendor == "pcan") can.vendor = "peak";  // as its library is called
  if (can.vendor != "esd" && can.vendor != "peak")
    throw cli::ExitError(cli::kUsage, "--can " + text + ": must be esd or peak");
  return can;
}

BusOption parse_bus(const std::string& text) {
  const auto equals = text.find('=');
  const auto kind = equals == std::string::npos ? std::string() : text.substr(equals + 1);
  if (equals == 0 || (kind != "pty" && kind != "slcan" && kind != "tcp"))
    throw cli::ExitError(cli::kUsage, "--bus " + text + ": must be PART=pty, PART=slcan or PART=tcp");
  return {text.substr(0, equals), kind};
}

std::string bus_address(const std::string& part, const std::string& kind, const fs::path& folder) {
  if (kind == "tcp") return part + "=tcp:0";
  return part + "=" + kind + ":" + (folder / (part + (kind == "pty" ? ".tty" : ".can"))).string();
}

std::vector<Placement> placements_of(const std::vector<TtyOption>& ttys,
                                     const std::vector<protocol::PartBus>& buses, Advice advice) {
  std::vector<Placement> all;
  for (const auto& [device, part] : ttys) {
    const auto path = bus_of(buses, part, "pty", advice);
    std::error_code error;
    const auto real = fs::canonical(path, error);
    if (error)
      throw cli::ExitError(cli::kFailed,
                           path + ": " + error.message() + "; the server must run on this machine");
    all.push_back({device, real});
  }
  return all;
}

std::string part_of_can(const CanOption& can, const std::vector<protocol::PartBus>& buses) {
  if (!can.part.empty()) return can.part;
  for (const auto& bus : buses)
    if (bus.name.starts_with("tcp:")) return bus.part;
  return {};  // lead_can() refuses that
}

void lead_can(const CanOption& can, const std::vector<protocol::PartBus>& buses, Advice advice) {
  const auto folder = run::own_folder().parent_path() / "lib" / "visum-can";
  const auto library = folder / (can.vendor == "esd" ? "libntcan.so" : "libpcan.so");
  if (!fs::exists(library)) throw cli::ExitError(cli::kFailed, "there is no " + library.string());
  const char* others = std::getenv("LD_LIBRARY_PATH");
  const auto path = folder.string() + (others && *others ? ":" + std::string(others) : "");
  ::setenv("LD_LIBRARY_PATH", path.c_str(), 1);
  ::setenv("VISUM_CAN", ("127.0.0.1:" + bus_of(buses, can.part, "tcp", advice)).c_str(), 1);
}

}  // namespace visum::exec
