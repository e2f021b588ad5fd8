// A program that we start: its output line by line, and its end. Nothing of it is left over: it gets a
// process group of its own, which is killed when the program ends or this object goes. If our process dies,
// the kernel kills the program itself. One thread uses it; callbacks run only inside of its calls.
#pragma once

#include <poll.h>
#include <sys/types.h>

#include <chrono>
#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "protocol/processes/spawn.h"

namespace visum::processes {

struct ExitStatus {
  bool by_signal = false;
  int number = 0;            // exit code or signal
  std::string text() const;  // "exited with code 3", "was ended by signal 9 (Killed)"
};

class ChildProcess {
 public:
  using OnLine = std::function<void(const std::string& line)>;

  // Starts argv[0], looked up in PATH if it has no slash. `in_fd` becomes its standard input, and stays the
  // caller's; -1: it reads nothing. Throws std::runtime_error if it cannot be started.
  ChildProcess(std::string name, const std::vector<std::string>& argv, OnLine on_out, OnLine on_err,
               int in_fd = -1);
  // A process that another one started for us: that one kills what is left of the group, and says how it
  // ended. `find_end` asks for that without waiting.
  struct Foreign {
    Spawned spawned;
    int exit_fd;  // its pidfd
    std::function<std::optional<ExitStatus>()> find_end;
  };
  ChildProcess(std::string name, Foreign process, OnLine on_out, OnLine on_err);
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  const std::string& name() const { return name_; }
  void add_to(std::vector<pollfd>& set) const;    // adds its open pipes, to poll for input
  int exit_fd() const { return exit_fd_; }        // can be read once the program has ended; -1: there is none
  void drain();                                   // passes on the lines that are there, without waiting
  const std::optional<ExitStatus>& check_exit();  // without waiting
  const std::optional<ExitStatus>& exit() const { return exit_; }  // as the last check_exit() found it
  // Processor time of the program and of all that it waited for, once check_exit() has found its end. 0
  // before, and of a process that another one started.
  double processor_s() const { return processor_s_; }
  bool wait_exit(std::chrono::milliseconds patience);
  void signal(int number) const;
  // Sends SIGINT, and SIGKILL after `patience`. Returns when the program has ended.
  void stop(std::chrono::milliseconds patience);

  const std::deque<std::string>& last_lines() const { return last_lines_; }  // of both outputs, newest last
  void forget_lines() { last_lines_.clear(); }
  static constexpr std::size_t kKeptLines = 40;
  static constexpr std::size_t kLongestLine = 4096;

 private:
  struct Pipe {
    int fd = -1;
    std::string partial;  // line
    OnLine on_line;
  };
  void read_pipe(Pipe& pipe);
  void take_line(Pipe& pipe);
  void close_pipe(Pipe& pipe);

  std::string name_;
  pid_t pid_ = -1;
  int exit_fd_ = -1;
  Pipe out_, err_;
  std::function<std::optional<ExitStatus>()> find_end_;  // empty: it is our own child
  std::deque<std::string> last_lines_;
  std::optional<ExitStatus> exit_;
  double processor_s_ = 0.0;
};

}  // namespace visum::processes
