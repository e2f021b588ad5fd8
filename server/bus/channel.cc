#include "server/bus/channel.h"

#include <linux/can.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <string_view>

namespace visum::bus {
namespace {

using powercube::BusFraming;
using powercube::CanFrame;
using powercube::Progress;
using powercube::SlcanDecoded;
using powercube::Telegram;

constexpr std::size_t kRead = 512;  // bytes at once
constexpr int kFramesAtOnce = 64;   // of the kernel's
constexpr std::string_view kDone = "\r", kWrong = "\a", kSent = "z\r", kVersion = "V1013\r",
                           kSerialNumber = "NV001\r", kNoFlags = "F00\r";

std::span<const std::uint8_t> bytes_of(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

bool would_block(int error) {
  return error == EAGAIN || error == EWOULDBLOCK || error == EINTR;
}

CanFrame from_kernel(const can_frame& frame) {
  CanFrame ours;
  ours.extended = (frame.can_id & CAN_EFF_FLAG) != 0;
  ours.remote = (frame.can_id & (CAN_RTR_FLAG | CAN_ERR_FLAG)) != 0;
  ours.id = frame.can_id & (ours.extended ? CAN_EFF_MASK : CAN_SFF_MASK);
  ours.size = std::min<std::uint8_t>(frame.can_dlc, 8);
  std::copy_n(frame.data, ours.size, ours.data.begin());
  return ours;
}

can_frame to_kernel(const CanFrame& ours) {
  can_frame frame{};
  frame.can_id = ours.id;
  frame.can_dlc = ours.size;
  std::copy_n(ours.data.begin(), ours.size, frame.data);
  return frame;
}

}  // namespace

Channel::~Channel() {
  ::close(fd_);
}

bool Channel::read(const OnTelegram& on_telegram) {
  return speech_ == Speech::kSocketCan ? read_can(on_telegram) : read_bytes(on_telegram);
}

bool Channel::read_bytes(const OnTelegram& on_telegram) {
  std::array<std::uint8_t, kRead> bytes;
  const auto count = ::read(fd_, bytes.data(), bytes.size());
  if (count < 0) return would_block(errno);
  if (count == 0) return false;
  const bool is_packet = reads_ == Reads::kPackets;
  if (is_packet && bytes[0] != TIOCPKT_DATA) {
    client_discarded_ |= (bytes[0] & TIOCPKT_FLUSHWRITE) != 0;
    return true;
  }
  received_.insert(received_.end(), bytes.begin() + (is_packet ? 1 : 0), bytes.begin() + count);
  heard_ += static_cast<std::uint64_t>(count);
  decode(on_telegram);
  return true;
}

bool Channel::read_can(const OnTelegram& on_telegram) {
  for (int i = 0; i < kFramesAtOnce; ++i) {
    can_frame frame;
    const auto count = ::read(fd_, &frame, sizeof frame);
    if (count < 0) return would_block(errno);
    if (count != static_cast<ssize_t>(sizeof frame)) return false;
    if (const auto telegram = powercube::from_can(from_kernel(frame)))
      on_telegram(*telegram, BusFraming::kCan);
  }
  return true;
}

void Channel::decode(const OnTelegram& on_telegram) {
  decide();
  if (speech_ == Speech::kSerial) take_serial(on_telegram);
  if (speech_ == Speech::kSlcan || speech_ == Speech::kSlcanHost) take_slcan(on_telegram);
}

// A serial frame begins with 02; a line of slcan begins with a letter, or with the CR that clears the line.
void Channel::decide() {
  while (speech_ == Speech::kUndecided && !received_.empty()) {
    const auto first = received_.front();
    if (first == 0x02) speech_ = Speech::kSerial;
    if (std::string_view("tTrROLCSsMmZXVvNF\r").find(static_cast<char>(first)) != std::string_view::npos)
      speech_ = Speech::kSlcan;
    if (speech_ == Speech::kUndecided) received_.erase(received_.begin());
  }
}

void Channel::take_serial(const OnTelegram& on_telegram) {
  std::size_t done = 0;
  for (;;) {
    const auto decoded = powercube::decode_serial(std::span(received_).subspan(done));
    if (decoded.progress == Progress::kNeedsMore) break;
    done += decoded.taken;
    if (decoded.progress == Progress::kComplete) on_telegram(decoded.telegram, BusFraming::kSerial);
  }
  received_.erase(received_.begin(), received_.begin() + static_cast<std::ptrdiff_t>(done));
}

void Channel::take_slcan(const OnTelegram& on_telegram) {
  std::size_t done = 0;
  for (;;) {
    const auto decoded = powercube::decode_slcan(std::span(received_).subspan(done));
    if (decoded.progress == Progress::kNeedsMore) break;
    done += decoded.taken;
    if (speech_ == Speech::kSlcanHost)
      hear_adapter(decoded, on_telegram);
    else if (decoded.progress == Progress::kBad)
      write(bytes_of(kWrong));
    else
      handle_adapter_command(decoded, on_telegram);
  }
  received_.erase(received_.begin(), received_.begin() + static_cast<std::ptrdiff_t>(done));
}

// Everything but frames ("z", CR, BEL) only acknowledges.
void Channel::hear_adapter(const SlcanDecoded& decoded, const OnTelegram& on_telegram) {
  if (decoded.progress == Progress::kBad || decoded.kind != SlcanDecoded::Kind::kFrame) return;
  if (const auto telegram = powercube::from_can(decoded.frame)) on_telegram(*telegram, BusFraming::kCan);
}

void Channel::handle_adapter_command(const SlcanDecoded& decoded, const OnTelegram& on_telegram) {
  const auto say = [this](std::string_view text) { write(bytes_of(text)); };
  switch (decoded.kind) {
    case SlcanDecoded::Kind::kFrame: {
      if (!open_ || listens_only_) return say(kWrong);
      say(kSent);
      if (const auto telegram = powercube::from_can(decoded.frame)) on_telegram(*telegram, BusFraming::kCan);
      return;
    }
    case SlcanDecoded::Kind::kOpen:
    case SlcanDecoded::Kind::kListen:
      open_ = true;
      listens_only_ = decoded.kind == SlcanDecoded::Kind::kListen;
      return say(kDone);
    case SlcanDecoded::Kind::kClose:
      open_ = false;
      return say(kDone);
    case SlcanDecoded::Kind::kSet:
      return say(kDone);
    case SlcanDecoded::Kind::kVersion:
      return say(kVersion);
    case SlcanDecoded::Kind::kSerialNumber:
      return say(kSerialNumber);
    case SlcanDecoded::Kind::kFlags:
      return say(kNoFlags);
  }
}

void Channel::send(const Telegram& telegram, bool corrupted) {
  if (speech_ == Speech::kSocketCan) {
    const auto frame = to_kernel(powercube::to_can(telegram));
    write({reinterpret_cast<const std::uint8_t*>(&frame), sizeof frame});
  } else if (is_can()) {
    const auto line = powercube::encode_slcan(powercube::to_can(telegram));
    if (open_ || speech_ == Speech::kSlcanHost) write(std::span(line.data).first(line.size));
  } else if (telegram.kind != Telegram::Kind::kState) {
    auto frame = powercube::encode_serial(telegram);
    if (corrupted) frame.data[frame.size - 2] ^= 0x40;  // in the check sum, just before the frame's end
    write(std::span(frame.data).first(frame.size));
  }
}

void Channel::write(std::span<const std::uint8_t> whole) {
  flush();
  const auto written = has_rest() ? 0 : write_some(whole);
  if (written == 0) {
    ++dropped_;
    return;
  }
  const auto rest = whole.subspan(written);
  rest_.assign(rest.begin(), rest.end());
}

void Channel::flush() {
  if (has_rest()) rest_.erase(rest_.begin(), rest_.begin() + static_cast<std::ptrdiff_t>(write_some(rest_)));
}

std::size_t Channel::write_some(std::span<const std::uint8_t> bytes) {
  const auto count = ::write(fd_, bytes.data(), bytes.size());
  if (count <= 0) return 0;
  written_ += static_cast<std::uint64_t>(count);
  return static_cast<std::size_t>(count);
}

}  // namespace visum::bus
