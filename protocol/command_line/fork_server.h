// A program that is loaded once and started many times. The fork server is a process that has done what comes
// before main(). For each command line that it is sent, it makes a copy of itself by fork(), which goes on as
// if it had just been started with these words: it has nothing of the copies before it. That saves loading,
// not more. One copy at a time; each end on the one thread of its process.
//
// Both ends talk over a socket of AF_UNIX and SOCK_SEQPACKET, which is the server's standard input:
//   client  the words, a zero byte behind each, with two descriptors: stdout and stderr of the copy
//   server  Begun, with a pidfd of the copy
//   server  Ended, once the copy and the rest of its process group are gone
#pragma once

#include <sys/types.h>

#include <optional>
#include <string>
#include <vector>

namespace visum::command_line {

struct Forked {
  pid_t pid;    // also of its process group
  int exit_fd;  // its pidfd, which can be read once it has ended; belongs to the caller
};

struct ForkEnded {
  bool by_signal;
  int number;  // exit code or signal
};

// The server's end. Returns 0 once the client has gone; in a copy, what `act` makes of its words. The kernel
// kills a copy whose server dies. The process must have no other thread yet.
int serve_forks(int socket, int (*act)(int argc, char** argv));

// ------------------------------------------------------------------------------------ the client's end
// Asks for a copy and waits until it has begun. Returns nothing where the server is gone, cannot fork, or the
// words are too many: start the program in the ordinary way.
std::optional<Forked> ask_for_fork(int socket, const std::vector<std::string>& words, int out_fd, int err_fd);
// How the copy ended, without waiting; nothing: it has not. A server that is gone took its copy along.
std::optional<ForkEnded> find_end_of_fork(int socket);

}  // namespace visum::command_line
