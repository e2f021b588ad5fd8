// One handle's connection to a CAN bus, which the daemon serves as slcan at a TCP port (`--bus
// PART=tcp:PORT`). Visum's replacements of the vendors' CAN libraries carry their frames over it. The
// environment names the bus: VISUM_CAN=HOST:PORT, set by `visum exec --can`. Two threads may use a line at
// once: one reads, one writes.
//
// A program may open several handles and read only one, as with a real driver. Each handle has a bounded
// queue, filtered by its ids. Every so often the handles in use take in what has come for the others, so that
// no socket fills up and holds back the bus.
#pragma once

#include <array>
#include <atomic>
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

  // For the program's own poll() or select(). From then on only read() and waiting() of this line empty its
  // socket: the program would wait for ever for frames that another handle has taken in.
  int descriptor() {
    watched_by_program_ = true;
    return fd_;
  }
  // Chooses the ids that are received; none at first.
  void hear(std::uint32_t id, bool heard);
  bool hears(std::uint32_t id) const;
  void hear_all();

  // Waits where the bus takes no more. False: the bus is gone.
  bool write(const Frame& frame);
  // The next frame, waiting until `due` at most.
  std::optional<Frame> read(Clock::time_point due);
  // True if read() would have a frame at once.
  bool waiting();
  bool gone() const { return gone_; }
  // Frames that were lost since the last call, because the queue was full.
  unsigned take_lost();

 private:
  explicit CanLine(int fd);
  // Counts a call, and now and then takes in the frames that have come for all lines.
  void serve_lines();
  void take_in();  // what is there, without waiting
  bool receive(Clock::time_point due);
  void take_lines();
  void take_line(const std::string& line);

  static constexpr std::size_t kMostFrames = 2048;  // in the queue; more are lost, as with a real driver
  static constexpr std::size_t kIds = 0x800;

  int fd_;
  std::atomic<bool> gone_ = false, watched_by_program_ = false;
  unsigned lost_ = 0;
  mutable std::mutex reading_, writing_;
  std::bitset<kIds> heard_;
  std::string text_;  // not decoded yet
  std::deque<Frame> frames_;
};

}  // namespace visum::canlib
