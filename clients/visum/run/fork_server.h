// Starts a server program again and again without loading it again: see protocol/command_line/fork_server.h.
// Each process is as new as if it had been started in the ordinary way. Main thread.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "protocol/processes/child_process.h"

namespace visum::run {

class ForkServer {
 public:
  ForkServer() = default;
  ~ForkServer() { end(); }
  ForkServer(const ForkServer&) = delete;
  ForkServer& operator=(const ForkServer&) = delete;

  // As ChildProcess's constructor, which it calls where there is no fork server or it fails. The server is
  // begun at the first call, with the environment of that moment; argv[0] is the same in all calls. One
  // process at a time, which must be gone before the next begins and before this object goes.
  std::unique_ptr<processes::ChildProcess> start(const std::string& name,
                                                 const std::vector<std::string>& argv,
                                                 processes::ChildProcess::OnLine on_out,
                                                 processes::ChildProcess::OnLine on_err);

 private:
  void begin(const std::string& program);
  void end();
  std::optional<processes::ChildProcess::Foreign> fork(const std::vector<std::string>& argv);

  int socket_ = -1;  // -1: there is no server
  std::optional<processes::ChildProcess> server_;
};

}  // namespace visum::run
