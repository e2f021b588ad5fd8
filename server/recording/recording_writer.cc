#include "server/recording/recording_writer.h"

#include <fcntl.h>
#include <spdlog/spdlog.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <utility>

namespace visum::recording {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr milliseconds kRound{10};   // how often the thread looks at its queue
constexpr milliseconds kFlush{500};  // how long a message waits for its chunk to be full
constexpr milliseconds kRoom{1};     // how often the tick's thread looks for room
constexpr std::chrono::seconds kPatience{10};
// After so many bytes the thread lets others have its processor. Where a controller looks for its answer
// there (protocol/busy_wait.h), it finds it within some 20 µs, not when all that waits is written.
constexpr std::size_t kTurn = 8u << 10;        // of messages; a longer one is a turn of its own
constexpr std::size_t kWriteTurn = 32u << 10;  // handed to the operating system

int make_file(const std::filesystem::path& file) {
  const auto fail = [&](int fd, const char* why) {
    if (fd >= 0) ::close(fd);
    throw std::runtime_error(why);
  };
  const int fd = ::open(file.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0644);
  if (fd < 0) fail(fd, std::strerror(errno));
  struct stat what {};
  if (::fstat(fd, &what) != 0 || !S_ISREG(what.st_mode)) return fd;
  // Not every file system has locks. Without them, nothing shows that another program writes the file.
  if (::flock(fd, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) fail(fd, "another program is writing it");
  // Where an empty file is cut, too, some file systems wait for the disk when it is closed.
  if (::fstat(fd, &what) != 0 || (what.st_size > 0 && ::ftruncate(fd, 0) != 0))
    fail(fd, std::strerror(errno));
  return fd;
}

}  // namespace

RecordingWriter::RecordingWriter(const std::filesystem::path& file, Overflow overflow)
    : file_(file),
      overflow_(overflow),
      out_{make_file(file)},
      writer_([this](Bytes bytes) { write(bytes); }, "visumd") {}

RecordingWriter::~RecordingWriter() {
  close();
}

bool RecordingWriter::close() {
  if (thread_.joinable()) {
    {
      const std::lock_guard lock(mutex_);
      stopping_ = true;
    }
    stopped_.notify_one();
    thread_.join();
  }
  return !ended();
}

RecordingWriter::Descriptor::~Descriptor() {
  ::close(fd);
}

void RecordingWriter::start() {
  thread_ = std::thread([this] { run(); });
  started_ = true;
}

void RecordingWriter::put_first(std::uint16_t channel, std::uint64_t publish_time_ns, Bytes data) {
  writer_.write(channel, 0, publish_time_ns, data);
  last_publish_ns_ = publish_time_ns;
}

// Where the tick waits for room anyway, the answer must not depend on the disk: equal runs make equal files.
bool RecordingWriter::has_room_for(std::size_t bytes) const {
  return bytes <= (overflow_ == Overflow::kWait ? kQueueBytes : queue_.room()) / 2;
}

void RecordingWriter::put(std::uint16_t channel, std::uint64_t log_time_ns, std::uint64_t publish_time_ns,
                          Bytes data) {
  if (ended()) return;
  const Head head{channel, static_cast<std::uint32_t>(data.size()), log_time_ns, publish_time_ns};
  const std::array pieces{std::as_bytes(std::span(&head, 1)), data};
  if (!make_room(sizeof head + data.size()) || !queue_.put(pieces))
    end("the disk is slower than the world; what waited for it is " + std::to_string(kQueueBytes >> 20) +
        " MiB");
}

bool RecordingWriter::make_room(std::size_t bytes) {
  if (queue_.room() >= bytes) return true;
  if (overflow_ == Overflow::kEnd) return false;
  const auto give_up = Clock::now() + kPatience;
  while (queue_.room() < bytes && Clock::now() < give_up && !ended()) std::this_thread::sleep_for(kRoom);
  return queue_.room() >= bytes;
}

void RecordingWriter::put_line(std::uint16_t channel, std::vector<std::byte> data) {
  const std::lock_guard lock(mutex_);
  if (lines_.size() < kMaxLines) lines_.push_back({channel, std::move(data)});
}

// Takes no memory: there may be none left.
void RecordingWriter::end(std::string_view why) {
  if (!ended_.exchange(true)) spdlog::error("the recording '{}' ends early: {}", file_.c_str(), why);
}

void RecordingWriter::run() try {
  auto flushed = Clock::now();
  for (bool stopping = false; !stopping;) {
    {
      std::unique_lock lock(mutex_);
      stopping = stopped_.wait_for(lock, kRound, [this] { return stopping_; });
    }
    work();
    if (Clock::now() - flushed < kFlush) continue;
    writer_.flush();
    flushed = Clock::now();
  }
  // A recording that ended early gets no end, so that whoever reads it is told that something is missing.
  if (ended())
    writer_.flush();
  else
    writer_.close();
} catch (const std::bad_alloc&) {
  end(kNoMemory);
} catch (const std::exception& error) {
  end(error.what());
}

void RecordingWriter::work() {
  write_lines();
  Head head{};
  for (std::size_t since = 0; queue_.waiting() > 0; since += head.size) {
    if (since >= kTurn) {
      std::this_thread::yield();
      since = 0;
    }
    queue_.take(std::as_writable_bytes(std::span(&head, 1)));
    last_log_ns_ = head.log_time_ns;
    last_publish_ns_ = head.publish_time_ns;
    queue_.take(writer_.begin_message(head.channel, head.log_time_ns, head.publish_time_ns, head.size));
    writer_.end_message();
  }
}

void RecordingWriter::write_lines() {
  std::vector<LogEntry> lines;
  {
    const std::lock_guard lock(mutex_);
    lines.swap(lines_);
  }
  for (const auto& line : lines) writer_.write(line.channel, last_log_ns_, last_publish_ns_, line.data);
}

void RecordingWriter::write(Bytes bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(out_.fd, bytes.data(), std::min(bytes.size(), kWriteTurn));
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) throw std::runtime_error(std::strerror(errno));
    bytes = bytes.subspan(static_cast<std::size_t>(written));
    if (!bytes.empty()) std::this_thread::yield();
  }
}

}  // namespace visum::recording
