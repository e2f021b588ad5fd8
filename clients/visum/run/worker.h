// A process that makes one run after another: `visum run FILE --worker`. It has read the scenario and loaded
// visumd once; each world is made by a process of its own (fork_server.h). Its standard input has a line of
// JSON for each run. It says "done" on its standard output when the run's result is written.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "protocol/config/config.h"
#include "protocol/processes/child_process.h"

namespace visum::run {

struct WorkerTask {
  std::size_t run = 0;
  std::string values{};               // the sweep's, as YAML; empty: those of the run's number
  std::filesystem::path result;       // a file for its report
  std::filesystem::path recording{};  // a file; empty: none
};

// {"run":3,"values":"","result":"/tmp/visum-1/3.json","recording":""}
std::string as_line(const WorkerTask& task);
WorkerTask read_task(const std::string& line);  // throws config::ConfigError

// The side that starts the process and gives it work. Main thread.
class Worker {
 public:
  // `command`: visum, run, the file, --worker, and the options of each run. Throws std::runtime_error if it
  // cannot be started.
  explicit Worker(const std::vector<std::string>& command);
  ~Worker();
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  processes::ChildProcess& process() { return *process_; }
  // The process has no other task. One that has ended meanwhile does not take it: see process().
  void give(const WorkerTask& task);
  bool has_done() const { return done_; }  // the task that it was given last
  std::size_t tasks_given() const { return tasks_given_; }
  void give_no_more();  // it ends by itself

 private:
  int in_fd_ = -1;
  bool done_ = false;
  std::size_t tasks_given_ = 0;
  std::optional<processes::ChildProcess> process_;
};

}  // namespace visum::run
