#include "server/programs/program.h"

#include <spdlog/details/os.h>
#include <spdlog/spdlog.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <iostream>
#include <memory>
#include <new>
#include <stdexcept>
#include <system_error>
#include <thread>

#include "protocol/command_line/output.h"
#include "protocol/config/config.h"
#include "protocol/json_text.h"
#include "server/dynamics/kinds/engine_kinds.h"
#include "server/programs/log_writer.h"

namespace visum::programs {
namespace {

// The kernel may run the signal handler on any thread, so all that it touches is atomic.
std::atomic<gateway::Daemon*> running_daemon = nullptr;
std::atomic<int> caught_signal = 0, handlers = 0;
static_assert(std::atomic<gateway::Daemon*>::is_always_lock_free && std::atomic<int>::is_always_lock_free);

void on_signal(int signal) {
  ++handlers;
  caught_signal = signal;
  if (gateway::Daemon* const daemon = running_daemon) daemon->stop();
  --handlers;
}

// Lets signals stop the daemon for as long as this object lives. Its destructor waits for handlers that still
// run, so that none of them touches a daemon that is gone.
struct Stoppable {
  explicit Stoppable(gateway::Daemon& daemon) { running_daemon = &daemon; }
  Stoppable(const Stoppable&) = delete;
  Stoppable& operator=(const Stoppable&) = delete;
  ~Stoppable() {
    running_daemon = nullptr;
    while (handlers > 0) std::this_thread::yield();
  }
};

void catch_signals() {
  struct sigaction action {};
  action.sa_handler = on_signal;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  // The terminal is closed. Under nohup this signal is ignored, and stays so.
  struct sigaction before {};
  if (sigaction(SIGHUP, nullptr, &before) == 0 && before.sa_handler != SIG_IGN)
    sigaction(SIGHUP, &action, nullptr);
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);  // a recording at its size limit ends; the world goes on
}

// Tells systemd that the service is ready (sd_notify(3), Type=notify).
void notify_manager() {
  const char* path = std::getenv("NOTIFY_SOCKET");
  if (!path || !*path) return;
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::strncpy(address.sun_path, path, sizeof address.sun_path - 1);
  const auto length = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + std::strlen(address.sun_path));
  if (address.sun_path[0] == '@') address.sun_path[0] = '\0';
  const int fd = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (fd < 0) return;
  constexpr char kReady[] = "READY=1";
  if (::sendto(fd, kReady, sizeof kReady - 1, 0, reinterpret_cast<sockaddr*>(&address), length) < 0)
    spdlog::warn("NOTIFY_SOCKET: {}", std::strerror(errno));
  ::close(fd);
}

// {"arm":["pty:arm.tty","tcp:40123"]}
std::string buses_as_json(const bus::BusNames& buses) {
  std::string json;
  for (const auto& [part, names] : buses) {
    std::string list;
    for (const auto& name : names) list += (list.empty() ? "" : ",") + protocol::json_quoted(name);
    json += (json.empty() ? "" : ",") + protocol::json_quoted(part) + ":[" + list + "]";
  }
  return "{" + json + "}";
}

// The host for a browser on this machine: an address that means "any" becomes localhost.
std::string page_host(const std::string& address) {
  if (address == "0.0.0.0" || address == "::") return "localhost";
  return address.find(':') == std::string::npos ? address : "[" + address + "]";
}

std::string page_url(const gateway::DaemonOptions& options, std::uint16_t port) {
  return (options.tls.given() ? "https://" : "http://") + page_host(options.address) + ":" +
         std::to_string(port) + "/";
}

void print_ready(const gateway::Daemon& daemon, const cycle::Simulation& simulation,
                 const gateway::DaemonOptions& options) {
  const auto http = daemon.http_port();
  std::string parts;
  for (const auto& bound : simulation.parts())
    parts += (parts.empty() ? "" : ",") + protocol::json_quoted(bound.part->description().name);
  std::cout << "{\"ready\":true,\"port\":" << daemon.port()
            << (http == 0 ? ""
                          : ",\"http\":" + std::to_string(http) +
                                ",\"page\":" + protocol::json_quoted(page_url(options, http)))
            << ",\"scene\":" << protocol::json_quoted(simulation.scene().name) << ",\"parts\":[" << parts
            << "],\"buses\":" << buses_as_json(daemon.buses()) << "}\n";
  // Whoever started this program waits for the line.
  if (const auto lost = command_line::find_lost_output(); !lost.empty()) throw std::runtime_error(lost);
}

void log_ready(const gateway::Daemon& daemon, const cycle::Simulation& simulation,
               const gateway::DaemonOptions& options) {
  spdlog::info("{}: {} parts, listening on {}:{}", simulation.scene().name, simulation.parts().size(),
               options.address, daemon.port());
  spdlog::info("the engines use the loops for {}", dynamics::processor_build());
  if (const auto http = daemon.http_port(); http != 0) {
    if (options.http.port != 0 && http != options.http.port)
      spdlog::warn("port {} is taken; the page is at {}", options.http.port, http);
    spdlog::info("the page: {}", page_url(options, http));
  }
  for (const auto& [part, names] : daemon.buses())
    for (const auto& name : names) spdlog::info("{}: bus {}", part, name);
}

// std::thread throws this when the system refuses another thread.
bool is_no_thread(const std::system_error& error) {
  return error.code() == std::errc::resource_unavailable_try_again;
}
constexpr const char* kNoThread =
    "cannot start a thread: the limit of processes (ulimit -u, or the container's pids) or of memory is "
    "reached; raise it";

}  // namespace

void set_verbosity(int verbosity) {
  constexpr spdlog::level::level_enum kLevels[] = {spdlog::level::err, spdlog::level::warn,
                                                   spdlog::level::info, spdlog::level::debug};
  spdlog::set_level(kLevels[verbosity]);
}

void set_up_log(const std::string& name, int verbosity) {
  using namespace spdlog::details;
  const bool colours = !std::getenv("NO_COLOR") && os::in_terminal(stderr) && os::is_color_terminal();
  spdlog::set_default_logger(
      std::make_shared<spdlog::logger>(name, std::make_shared<LogWriter>(STDERR_FILENO, name, colours)));
  spdlog::set_pattern(name + ": %^%l%$: %v");
  set_verbosity(verbosity);
}

void end_log() {
  spdlog::default_logger()->flush();
}

int exit_code_of(const std::function<int()>& run) {
  try {
    return run();
  } catch (const config::ConfigError& error) {
    spdlog::error("{}", error.what());
    return kConfigWrong;
  } catch (const std::system_error& error) {
    spdlog::error("{}", is_no_thread(error) ? kNoThread : error.what());
    return kUsage;
  } catch (const std::bad_alloc&) {
    spdlog::error("out of memory: the limit (ulimit -v, or the container's) is reached; raise it");
    return kUsage;
  } catch (const std::exception& error) {
    spdlog::error("{}", error.what());
    return kUsage;
  }
}

void end_at_once(Exit code) {
  end_log();
  std::_Exit(code);
}

int run_until_signal(gateway::Daemon& daemon, const cycle::Simulation& simulation,
                     const gateway::DaemonOptions& options, bool json) {
  const Stoppable stoppable(daemon);
  catch_signals();
  if (json)
    print_ready(daemon, simulation, options);
  else
    log_ready(daemon, simulation, options);
  notify_manager();
  daemon.run();
  return caught_signal;
}

}  // namespace visum::programs
