// The visumd of a scenario: the constructor starts it on a free port, the destructor ends it. Main thread.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "clients/visum/run/fork_server.h"
#include "clients/visum/run/wait_loop.h"
#include "protocol/processes/child_process.h"

namespace visum::run {

struct DaemonOptions {
  std::filesystem::path program;  // find_visumd()
  std::filesystem::path scene;
  std::string clock;
  std::uint16_t port = 0;  // 0: any free one
  std::optional<std::string> engine;
  std::optional<std::int64_t> seed;
  std::vector<std::string> buses{};    // as --bus takes them
  std::string record{};                // a recording's file; empty: none
  bool record_if_possible = false;     // it is only a warning if that cannot be written
  std::string parameters{};            // of the scene, as --parameters takes them; empty: its defaults
  std::vector<std::string> plugins{};  // folders
  std::optional<double> node_timeout_s{};
  bool caches = true;           // meshes that it converts
  std::string profile{};        // visumd writes its profile here; empty: nothing is measured
  bool profile_spans = false;   // with a trace in it
  std::string used_files{};     // visumd writes here what it read; empty: nowhere
  int threads = 1;              // of the engine
  bool serves_page = false;     // and metrics, over HTTP
  double speedup = 0.0;         // 0: the scene's, and in lockstep none
  ForkServer* forks = nullptr;  // starts it; null: it is started in the ordinary way
  // Called once it has ended, with its processor time. Not with `forks`, whose processes are not ours.
  std::function<void(double processor_s)> on_end{};
};

// The folder of the program that runs now.
std::filesystem::path own_folder();
// The path of a server program: beside our own, else as PATH finds it.
std::filesystem::path find_server(const std::string& program);
std::filesystem::path find_visumd();
// Reads DaemonOptions::used_files: paths and the XXH64 of their contents.
std::vector<std::pair<std::string, std::string>> read_used_files(const std::string& file);

class Daemon {
 public:
  // Returns when clients can connect. Throws cli::ExitError: kBadConfig if visumd says that the scene is
  // wrong, kUsage if it refuses its options, kInvalid if it is not ready within `patience_s`.
  Daemon(const DaemonOptions& options, double patience_s, WaitLoop& wait_loop,
         processes::ChildProcess::OnLine on_line);
  ~Daemon();
  Daemon(const Daemon&) = delete;
  Daemon& operator=(const Daemon&) = delete;

  std::uint16_t port() const { return port_; }
  std::uint16_t page_port() const { return page_port_; }  // 0: it serves no page
  // The place of each part's last bus, which is the one that we asked for: a path, or HOST:PORT for tcp.
  const std::map<std::string, std::string>& buses() const { return buses_; }
  processes::ChildProcess& process() { return *process_; }
  // Why it ended, with its last lines; empty while it runs.
  std::string obituary();

 private:
  void wait_until_ready(double patience_s);

  WaitLoop& wait_loop_;
  const std::function<void(double)> on_end_;
  std::string ready_line_;
  std::uint16_t port_ = 0, page_port_ = 0;
  std::map<std::string, std::string> buses_;
  std::unique_ptr<processes::ChildProcess> process_;
};

}  // namespace visum::run
