#include "clients/visum/run/daemon.h"

#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <system_error>

#include "clients/visum/common/exit_code.h"
#include "clients/visum/common/format.h"
#include "protocol/config/config.h"
#include "protocol/local_socket.h"

namespace visum::run {
namespace {

using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

constexpr milliseconds kFarewell{5000};  // time to end its tick and its sessions

std::vector<std::string> command_line(const DaemonOptions& options) {
  std::vector<std::string> argv{options.program.string(),
                                options.scene.string(),
                                "--json",
                                "-v",
                                "1",
                                "--clock",
                                options.clock,
                                "--port",
                                std::to_string(options.port)};
  if (!options.serves_page) argv.insert(argv.end(), {"--http", "off"});
  if (options.engine) argv.insert(argv.end(), {"--engine", *options.engine});
  for (const auto& bus : options.buses) argv.insert(argv.end(), {"--bus", bus});
  if (options.speedup > 0.0) argv.insert(argv.end(), {"--speedup", cli::exact(options.speedup)});
  if (options.threads > 1) argv.insert(argv.end(), {"--threads", std::to_string(options.threads)});
  if (!options.record.empty())
    argv.insert(argv.end(), {options.record_if_possible ? "--try-record" : "--record", options.record});
  if (!options.parameters.empty()) argv.insert(argv.end(), {"--parameters", options.parameters});
  for (const auto& folder : options.plugins) argv.insert(argv.end(), {"--plugins", folder});
  if (options.node_timeout_s)
    argv.insert(argv.end(), {"--node-timeout", cli::exact(*options.node_timeout_s)});
  if (!options.caches) argv.push_back("--no-cache");
  if (!options.profile.empty()) argv.insert(argv.end(), {"--profile", options.profile});
  if (!options.profile.empty() && !options.profile_spans) argv.insert(argv.end(), {"--profile-spans", "0"});
  if (!options.used_files.empty()) argv.insert(argv.end(), {"--used-files", options.used_files});
  if (options.seed) argv.insert(argv.end(), {"--seed", std::to_string(*options.seed)});
  return argv;
}

std::string join_lines(const std::deque<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += (text.empty() ? "" : "\n") + line;
  return text;
}

// "pty:/tmp/arm.tty" leads to that path, "tcp:40123" to a port of this machine.
std::string place_of(const std::string& bus) {
  const auto colon = bus.find(':');
  const auto where = bus.substr(colon + 1);
  return bus.substr(0, colon) == "tcp" ? "127.0.0.1:" + where : where;
}

struct Ready {
  std::uint16_t port = 0, http = 0;
  std::map<std::string, std::string> buses;
};

// JSON is YAML, so the YAML reader reads it.
Ready read_ready(const std::string& ready_line) try {
  const auto node = config::load_text(ready_line, "visumd's ready line");
  if (!node.get("ready").boolean()) node.fail("not ready");
  Ready ready{static_cast<std::uint16_t>(node.get("port").integer(1, 65535)), 0, {}};
  if (const auto http = node.find("http")) ready.http = static_cast<std::uint16_t>(http->integer(1, 65535));
  if (const auto buses = node.find("buses"))
    for (const std::string& part : buses->keys())
      ready.buses[part] = place_of(buses->get(part).at(buses->get(part).size() - 1).text());
  return ready;
} catch (const config::ConfigError& error) {
  throw cli::ExitError(cli::kInvalid, std::string("visumd said what is no ready line: ") + error.what());
}

}  // namespace

std::filesystem::path own_folder() {
  std::error_code error;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", error);
  return error ? std::filesystem::path() : self.parent_path();
}

std::filesystem::path find_server(const std::string& program) {
  const auto beside = own_folder() / program;
  return ::access(beside.c_str(), X_OK) == 0 ? beside : std::filesystem::path(program);
}

std::filesystem::path find_visumd() {
  return find_server("visumd");
}

std::vector<std::pair<std::string, std::string>> read_used_files(const std::string& file) {
  std::vector<std::pair<std::string, std::string>> files;
  std::ifstream lines(file);
  for (std::string line; std::getline(lines, line);)
    if (const auto blank = line.find(' '); blank != line.npos)
      files.emplace_back(line.substr(blank + 1), line.substr(0, blank));
  return files;
}

Daemon::Daemon(const DaemonOptions& options, double patience_s, WaitLoop& wait_loop,
               processes::ChildProcess::OnLine on_line)
    : wait_loop_(wait_loop), on_end_(options.on_end) {
  // It serves plain text on loopback, so no client that we start may try TLS because of the environment. It
  // is not the service either that a service manager waits for.
  for (const char* variable : {"VISUM_TLS_CA", "VISUM_TLS_CERT", "VISUM_TLS_KEY", "NOTIFY_SOCKET"})
    ::unsetenv(variable);
  protocol::share_local_sockets();
  try {
    const auto note_ready = [this](const std::string& line) {
      if (ready_line_.empty()) ready_line_ = line;
    };
    process_ =
        options.forks != nullptr
            ? options.forks->start("visumd", command_line(options), note_ready, on_line)
            : std::make_unique<processes::ChildProcess>("visumd", command_line(options), note_ready, on_line);
  } catch (const std::runtime_error& error) {
    throw cli::ExitError(cli::kInvalid, error.what());
  }
  wait_loop_.watch(*process_);
  try {
    wait_until_ready(patience_s);
  } catch (...) {
    wait_loop_.forget(*process_);
    throw;
  }
}

Daemon::~Daemon() {
  wait_loop_.forget(*process_);
  process_->stop(kFarewell);
  if (on_end_) on_end_(process_->processor_s());
}

void Daemon::wait_until_ready(double patience_s) {
  const auto give_up = Clock::now() + std::chrono::duration<double>(patience_s);
  while (ready_line_.empty()) {
    wait_loop_.wait(-1, milliseconds(20));
    // check_exit() also reads the last output, which may be the line that we wait for.
    if (const auto& exit = process_->check_exit(); exit && ready_line_.empty()) {
      const bool explained =
          !exit->by_signal && (exit->number == cli::kBadConfig || exit->number == cli::kUsage);
      const std::string words = join_lines(process_->last_lines());
      if (explained) throw cli::ExitError(static_cast<cli::ExitCode>(exit->number), words);
      throw cli::ExitError(cli::kInvalid, "visumd " + exit->text() + " before it was ready\n" + words);
    }
    if (Clock::now() > give_up) {
      throw cli::ExitError(cli::kInvalid, "visumd is not ready after " + cli::exact(patience_s) + " s");
    }
  }
  auto ready = read_ready(ready_line_);
  port_ = ready.port;
  page_port_ = ready.http;
  buses_ = std::move(ready.buses);
}

std::string Daemon::obituary() {
  if (!process_->wait_exit(milliseconds(500))) return {};
  return "visumd " + process_->check_exit()->text() + "\n" + join_lines(process_->last_lines());
}

}  // namespace visum::run
