// A bare echo over a pseudo terminal: the floor for the answer of a module on a pseudo terminal. A thread
// reads the master's side and writes back. Throws std::system_error if a system call fails.
#pragma once

#include <cstddef>
#include <thread>
#include <vector>

namespace visum::bench {

class PtyEcho {
 public:
  explicit PtyEcho(std::size_t bytes);
  ~PtyEcho();
  PtyEcho(const PtyEcho&) = delete;
  PtyEcho& operator=(const PtyEcho&) = delete;

  void round_trip();

 private:
  void serve() const;

  std::vector<char> bytes_;
  int master_ = -1, slave_ = -1;
  std::thread thread_;
};

}  // namespace visum::bench
