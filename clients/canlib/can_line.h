// A CAN bus behind a TCP port of the daemon's (`--bus PART=tcp:PORT`), which speaks slcan there: what Visum's
// replacements of the vendors' CAN libraries carry their frames over. Where it is stands in the environment,
// VISUM_CAN=HOST:PORT; `visum exec --can` sets it. Two threads at once may use a line: one reads, one writes.
#pragma once

#include <array>
#include <bitset>
#include <chrono>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

namespace visum::canlib {

struct Frame {
  std::uint32_t id = 0;  // 11 bits
  std::uint8_t size = 0;
  std::array<std::uint8_t, 8> data{};
};

class CanLine {
 public:
  using Clock = std::chrono::steady_clock;

  // Connects to where VISUM_CAN says. Null, with a word on stderr that begins with `library`, where that does
  // not work.
  static std::unique_ptr<CanLine> open(const char* library);
  ~CanLine();
  CanLine(const CanLine&) = delete;
  CanLine& operator=(const CanLine&) = delete;

  int descriptor() const { return fd_; }
  // Which ids are heard; at first none.
  void hear(std::uint32_t id, bool heard);
  bool hears(std::uint32_t id) const;
  void hear_all();

  bool write(const Frame& frame);  // false: the bus is gone
  // The next frame, waiting until `due` at most.
  std::optional<Frame> read(Clock::time_point due);
  // True if read() would have a frame at once.
  bool waiting();
  bool gone() const { return gone_; }

 private:
  explicit CanLine(int fd) : fd_(fd) {}
  bool receive(Clock::time_point due);
  void take_lines();
  void take_line(const std::string& line);

  static constexpr std::size_t kMostFrames = 2048;  // received; more are lost, as in a real queue
  static constexpr std::size_t kIds = 0x800;

  int fd_;
  bool gone_ = false;
  mutable std::mutex reading_, writing_;
  std::bitset<kIds> heard_;
  std::string text_;  // not decoded yet
  std::deque<Frame> frames_;
};

}  // namespace visum::canlib
