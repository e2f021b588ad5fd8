// One stream of bytes with a client's program at its other end, and the encoding that is spoken on it. One
// thread at a time. Nothing blocks. Where the other end does not read, frames and lines are lost, as on a
// real line that nobody reads; but only whole ones. The rest of one that was begun is kept until there is
// room.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "hwparts/powercube/can_codec.h"
#include "hwparts/powercube/module.h"

namespace visum::bus {

enum class Speech {
  kUndecided,  // TCP: the first byte tells
  kSerial,     // RS-232 frames
  kSlcan,      // CAN frames as lines of text; we are the adapter
  kSlcanHost,  // the same from the other side: an adapter, opened already, is there
  kSocketCan,  // CAN frames of the kernel
};

class Channel {
 public:
  using OnTelegram = std::function<void(const powercube::Telegram&, powercube::BusFraming)>;

  enum class Reads { kBytes, kPackets };  // packets: a pseudo terminal's, with TIOCPKT

  // Owns fd, which must not block.
  Channel(int fd, Speech speech, Reads reads = Reads::kBytes, std::uint16_t port = 0)
      : fd_(fd), speech_(speech), reads_(reads), port_(port) {}
  ~Channel();
  Channel(const Channel&) = delete;
  Channel& operator=(const Channel&) = delete;

  int fd() const { return fd_; }
  // On a CAN bus each client hears everything, on a serial line only its own answers.
  bool is_can() const { return speech_ != Speech::kUndecided && speech_ != Speech::kSerial; }

  std::uint16_t port() const { return port_; }        // TCP: the client's; else 0
  std::uint64_t heard() const { return heard_; }      // bytes read so far
  std::uint64_t written() const { return written_; }  // bytes written so far

  // Reads what is there and decodes it. False: the other end is gone.
  bool read(const OnTelegram& on_telegram);
  // True if the client has discarded its own output since the last call. Only known with Reads::kPackets.
  bool client_discarded() { return std::exchange(client_discarded_, false); }
  // `corrupted`: with a bit of the check sum flipped; serial lines only.
  void send(const powercube::Telegram& telegram, bool corrupted = false);
  // True: the rest of a frame or line waits for room. Then flush() is to be called once fd() is writable.
  bool has_rest() const { return !rest_.empty(); }
  void flush();
  std::uint64_t dropped() const { return dropped_; }  // frames and lines so far, for want of room

 private:
  // Bytes of a tty or a TCP connection.
  bool read_bytes(const OnTelegram& on_telegram);
  // Frames of a CAN interface of the kernel.
  bool read_can(const OnTelegram& on_telegram);
  void decode(const OnTelegram& on_telegram);
  // Finds out from the first byte which encoding a TCP client speaks.
  void decide();
  void take_serial(const OnTelegram& on_telegram);
  void take_slcan(const OnTelegram& on_telegram);
  // We are the host: takes frames, and skips what the adapter acknowledges.
  void hear_adapter(const powercube::SlcanDecoded& decoded, const OnTelegram& on_telegram);
  // We are the adapter: carries out a line of the host, and acknowledges it.
  void handle_adapter_command(const powercube::SlcanDecoded& decoded, const OnTelegram& on_telegram);
  // Writes one whole frame or line, or drops it.
  void write(std::span<const std::uint8_t> whole);
  // Writes what there is room for. Returns how many bytes that were.
  std::size_t write_some(std::span<const std::uint8_t> bytes);

  int fd_;
  Speech speech_;
  Reads reads_;
  std::uint16_t port_;
  std::uint64_t heard_ = 0, written_ = 0, dropped_ = 0;
  bool client_discarded_ = false;
  bool open_ = false;  // slcan: between "O" and "C"
  bool listens_only_ = false;
  std::vector<std::uint8_t> rest_;      // of the frame or line that was written in part
  std::vector<std::uint8_t> received_;  // not decoded yet; shorter than one read and one frame
};

}  // namespace visum::bus
