#include "clients/canlib/can_line.h"

#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <utility>
#include <vector>

namespace visum::canlib {
namespace {

constexpr const char* kVariable = "VISUM_CAN";
constexpr std::size_t kMostText = 4096;  // without an end of line: no slcan
// The lines of this process. A call in so many also serves the others: a socket's buffer holds more frames
// than that.
constexpr unsigned kCallsPerRound = 256;
constexpr int kMostReads = 128;  // for one line in a round: more bytes than so many calls bring
std::mutex lines_lock;
// Never destroyed: a program may end with handles open, whose lines end after this file's own variables.
std::vector<CanLine*>& lines = *new std::vector<CanLine*>;
std::atomic<unsigned> calls = 0;

// -1, and why not.
int connect_to(const std::string& host, const std::string& port, std::string& why) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  if (const int error = ::getaddrinfo(host.c_str(), port.c_str(), &hints, &found); error != 0) {
    why = ::gai_strerror(error);
    return -1;
  }
  int fd = -1;
  for (const auto* address = found; address && fd < 0; address = address->ai_next) {
    fd = ::socket(address->ai_family, address->ai_socktype | SOCK_CLOEXEC, address->ai_protocol);
    if (fd >= 0 && ::connect(fd, address->ai_addr, address->ai_addrlen) == 0) break;
    why = std::strerror(errno);
    if (fd >= 0) ::close(fd);
    fd = -1;
  }
  ::freeaddrinfo(found);
  const int on = 1;
  if (fd >= 0) ::setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  return fd;
}

bool send_all(int fd, const char* data, std::size_t size) {
  while (size > 0) {
    const auto sent = ::send(fd, data, size, MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent <= 0) return false;
    data += sent;
    size -= static_cast<std::size_t>(sent);
  }
  return true;
}

std::optional<unsigned> hexadecimal(const std::string& text, std::size_t at, std::size_t digits) {
  if (at + digits > text.size()) return std::nullopt;
  unsigned value = 0;
  const char* begin = text.data() + at;
  const auto [stopped, error] = std::from_chars(begin, begin + digits, value, 16);
  if (error != std::errc() || stopped != begin + digits) return std::nullopt;
  return value;
}

// "t0A140A1D1835"
std::optional<Frame> decode(const std::string& line) {
  if (line.empty() || line[0] != 't') return std::nullopt;
  const auto id = hexadecimal(line, 1, 3), size = hexadecimal(line, 4, 1);
  if (!id || !size || *size > 8) return std::nullopt;
  Frame frame{*id, static_cast<std::uint8_t>(*size), {}};
  for (std::size_t i = 0; i < *size; ++i) {
    const auto byte = hexadecimal(line, 5 + 2 * i, 2);
    if (!byte) return std::nullopt;
    frame.data[i] = static_cast<std::uint8_t>(*byte);
  }
  return frame;
}

}  // namespace

std::unique_ptr<CanLine> CanLine::open(const char* library) {
  const char* address = std::getenv(kVariable);
  const std::string text = address ? address : "";
  const auto colon = text.rfind(':');
  if (colon == std::string::npos) {
    std::fprintf(stderr, "%s: %s names no bus as HOST:PORT; run the program with `visum exec --can`\n",
                 library, kVariable);
    return nullptr;
  }
  std::string why;
  const int fd = connect_to(text.substr(0, colon), text.substr(colon + 1), why);
  constexpr char kOpening[] = "C\rO\r";
  if (fd < 0 || !send_all(fd, kOpening, sizeof kOpening - 1)) {
    if (fd >= 0) why = std::strerror(errno);
    std::fprintf(stderr, "%s: no bus at %s: %s\n", library, text.c_str(), why.c_str());
    if (fd >= 0) ::close(fd);
    return nullptr;
  }
  return std::unique_ptr<CanLine>(new CanLine(fd));
}

CanLine::CanLine(int fd) : fd_(fd) {
  const std::lock_guard lock(lines_lock);
  lines.push_back(this);
}

CanLine::~CanLine() {
  {
    const std::lock_guard lock(lines_lock);
    std::erase(lines, this);
  }
  ::close(fd_);
}

void CanLine::serve_lines() {
  if (++calls % kCallsPerRound != 0) return;
  const std::lock_guard lock(lines_lock);
  for (CanLine* line : lines)
    if (!line->watched_by_program_) line->take_in();
}

void CanLine::take_in() {
  const std::unique_lock lock(reading_, std::try_to_lock);
  if (!lock) return;  // its own reader is at it
  for (int reads = 0; reads < kMostReads && receive(Clock::now()); ++reads) {
  }
}

unsigned CanLine::take_lost() {
  const std::lock_guard lock(reading_);
  return std::exchange(lost_, 0);
}

void CanLine::hear(std::uint32_t id, bool heard) {
  const std::lock_guard lock(reading_);
  if (id < kIds) heard_[id] = heard;
}

bool CanLine::hears(std::uint32_t id) const {
  const std::lock_guard lock(reading_);
  return id < kIds && heard_[id];
}

void CanLine::hear_all() {
  const std::lock_guard lock(reading_);
  heard_.set();
}

bool CanLine::write(const Frame& frame) {
  char line[32];
  int size =
      std::snprintf(line, sizeof line, "t%03X%u", frame.id & 0x7FFU, static_cast<unsigned>(frame.size));
  for (std::size_t i = 0; i < frame.size; ++i)
    size += std::snprintf(line + size, sizeof line - static_cast<std::size_t>(size), "%02X", frame.data[i]);
  line[size++] = '\r';
  serve_lines();
  const std::lock_guard lock(writing_);
  return send_all(fd_, line, static_cast<std::size_t>(size));
}

std::optional<Frame> CanLine::read(Clock::time_point due) {
  serve_lines();
  const std::lock_guard lock(reading_);
  while (frames_.empty())
    if (!receive(due)) return std::nullopt;
  const auto frame = frames_.front();
  frames_.pop_front();
  return frame;
}

bool CanLine::waiting() {
  const std::lock_guard lock(reading_);
  while (frames_.empty())
    if (!receive(Clock::now())) return false;
  return true;
}

// One read, waiting for it until `due`. False: nothing came.
bool CanLine::receive(Clock::time_point due) {
  if (gone_) return false;
  const auto left = std::max(due - Clock::now(), Clock::duration{});
  const auto ns = std::chrono::duration_cast<std::chrono::nanoseconds>(left).count();
  const timespec wait{static_cast<time_t>(ns / 1'000'000'000), static_cast<long>(ns % 1'000'000'000)};
  pollfd set{fd_, POLLIN, 0};
  const bool for_ever = due == Clock::time_point::max();
  if (::ppoll(&set, 1, for_ever ? nullptr : &wait, nullptr) <= 0) return errno == EINTR && Clock::now() < due;
  char bytes[512];
  const auto count = ::read(fd_, bytes, sizeof bytes);
  if (count < 0 && errno == EINTR) return true;
  gone_ = count <= 0;
  if (gone_) return false;
  text_.append(bytes, static_cast<std::size_t>(count));
  take_lines();
  return true;
}

// Lines end with CR; "z" before it, or BEL, only acknowledges what was sent.
void CanLine::take_lines() {
  std::size_t begin = 0;
  for (auto end = text_.find('\r'); end != std::string::npos; end = text_.find('\r', begin)) {
    take_line(text_.substr(begin, end - begin));
    begin = end + 1;
  }
  text_.erase(0, begin);
  if (text_.size() > kMostText) text_.clear();
}

void CanLine::take_line(const std::string& line) {
  const auto from = line.find_first_not_of("\a\n");
  const auto frame = from == std::string::npos ? std::nullopt : decode(line.substr(from));
  if (!frame || frame->id >= kIds || !heard_[frame->id]) return;
  if (frames_.size() < kMostFrames)
    frames_.push_back(*frame);
  else
    ++lost_;
}

}  // namespace visum::canlib
