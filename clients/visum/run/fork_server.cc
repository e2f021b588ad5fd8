#include "clients/visum/run/fork_server.h"

#include <fcntl.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <cstdlib>
#include <stdexcept>
#include <utility>

#include "protocol/command_line/fork_server.h"

namespace visum::run {

std::unique_ptr<processes::ChildProcess> ForkServer::start(const std::string& name,
                                                           const std::vector<std::string>& argv,
                                                           processes::ChildProcess::OnLine on_out,
                                                           processes::ChildProcess::OnLine on_err) {
  if (socket_ < 0) begin(argv[0]);
  if (auto process = fork(argv))
    return std::make_unique<processes::ChildProcess>(name, std::move(*process), std::move(on_out),
                                                     std::move(on_err));
  end();
  return std::make_unique<processes::ChildProcess>(name, argv, std::move(on_out), std::move(on_err));
}

void ForkServer::begin(const std::string& program) {
  int ends[2];
  if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) != 0) return;
  // It looks up all names as it is loaded, so that its copies need not do so again.
  const bool lazily = ::getenv("LD_BIND_NOW") == nullptr;
  if (lazily) ::setenv("LD_BIND_NOW", "1", 1);
  try {
    server_.emplace("fork server", std::vector<std::string>{program, "fork-server"},
                    processes::ChildProcess::OnLine{}, processes::ChildProcess::OnLine{}, ends[1]);
    // One that gives no answer in that time is taken to be gone.
    const timeval patience{10, 0};
    ::setsockopt(ends[0], SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    socket_ = ends[0];
  } catch (const std::runtime_error&) {  // starting it in the ordinary way says why
    ::close(ends[0]);
  }
  if (lazily) ::unsetenv("LD_BIND_NOW");
  ::close(ends[1]);
}

// Without its socket the server ends by itself.
void ForkServer::end() {
  if (socket_ >= 0) ::close(std::exchange(socket_, -1));
  server_.reset();
}

std::optional<processes::ChildProcess::Foreign> ForkServer::fork(const std::vector<std::string>& argv) {
  if (socket_ < 0) return std::nullopt;
  const processes::PipeEnds out = processes::make_pipe(argv[0]), err = processes::make_pipe(argv[0]);
  const auto forked = command_line::ask_for_fork(socket_, argv, out.write, err.write);
  ::close(out.write);
  ::close(err.write);
  if (!forked) {
    ::close(out.read);
    ::close(err.read);
    return std::nullopt;
  }
  for (const int fd : {out.read, err.read}) ::fcntl(fd, F_SETFL, O_NONBLOCK);
  const auto find_end = [socket = socket_]() -> std::optional<processes::ExitStatus> {
    const auto ended = command_line::find_end_of_fork(socket);
    if (!ended) return std::nullopt;
    return processes::ExitStatus{ended->by_signal, ended->number};
  };
  return processes::ChildProcess::Foreign{{forked->pid, out.read, err.read}, forked->exit_fd, find_end};
}

}  // namespace visum::run
