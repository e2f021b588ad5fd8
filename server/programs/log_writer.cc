#include "server/programs/log_writer.h"

#include <poll.h>
#include <pthread.h>
#include <spdlog/pattern_formatter.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <condition_variable>
#include <csignal>
#include <string>
#include <system_error>
#include <thread>
#include <utility>

namespace visum::programs {
namespace {

using Clock = std::chrono::steady_clock;

// poll() promises room for so many bytes of a pipe (PIPE_BUF), so that write() does not block. O_NONBLOCK
// would be no help: it would hold for every program that shares our stderr.
constexpr std::size_t kPiece = 4096;

int milliseconds_until(Clock::time_point until) {
  const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - Clock::now()).count();
  return static_cast<int>(std::clamp<std::int64_t>(left, 0, 1000));
}

// Writes all of `text`, or as much as the descriptor takes until then. A reader that is gone takes
// everything.
bool write_all(int descriptor, std::string_view text, Clock::time_point until) {
  while (!text.empty()) {
    pollfd room{descriptor, POLLOUT, 0};
    const int ready = ::poll(&room, 1, milliseconds_until(until));
    if (ready == 0 && Clock::now() >= until) return false;
    if (ready <= 0) continue;
    const auto sent = ::write(descriptor, text.data(), std::min(text.size(), kPiece));
    if (sent < 0 && errno != EAGAIN && errno != EINTR) return true;
    if (sent > 0) text.remove_prefix(static_cast<std::size_t>(sent));
  }
  return true;
}

// As spdlog's own sinks have them.
std::string_view colour_of(spdlog::level::level_enum level) {
  if (level >= spdlog::level::err) return "\033[31m\033[1m";
  if (level == spdlog::level::warn) return "\033[33m\033[1m";
  return level == spdlog::level::info ? "\033[32m" : "\033[36m";
}

void append(std::string& to, const spdlog::memory_buf_t& text, std::size_t from, std::size_t end) {
  to.append(text.data() + from, end - from);
}

}  // namespace

struct LogWriter::Queue {
  Queue(int the_descriptor, std::string the_name) : descriptor(the_descriptor), name(std::move(the_name)) {
    waiting.reserve(kMaxWaiting);
    writing.reserve(kMaxWaiting);
  }

  // The writer's thread.
  void run() {
    std::unique_lock lock(mutex);
    for (;;) {
      wake.wait(lock, [this] { return ended || !waiting.empty(); });
      if (waiting.empty()) return;
      write_batch(lock, Clock::time_point::max());
    }
  }
  // Writes what waits, and then how much was dropped behind it.
  void write_batch(std::unique_lock<std::mutex>& lock, Clock::time_point until) {
    std::swap(waiting, writing);
    const auto lost = std::exchange(lost_behind, 0);
    is_writing = true;
    lock.unlock();
    write_all(descriptor, writing, until);
    if (lost > 0)
      write_all(
          descriptor,
          name + ": warning: " + std::to_string(lost) + " lines of the log were dropped: nobody read it\n",
          until);
    lock.lock();
    writing.clear();
    is_writing = false;
    written.notify_all();
  }

  const int descriptor;
  const std::string name;
  std::mutex mutex;
  std::condition_variable wake, written;
  std::string waiting;            // whole lines
  std::string writing;            // belongs to the writer while is_writing
  std::uint64_t lost_behind = 0;  // lines that were dropped since `waiting` became full
  std::uint64_t dropped = 0;
  bool has_thread = false, is_writing = false, ended = false;
};

LogWriter::LogWriter(int descriptor, const std::string& name, bool colours)
    : colours_(colours),
      queue_(std::make_shared<Queue>(descriptor, name)),
      formatter_(std::make_unique<spdlog::pattern_formatter>()) {
  // Signals are for the threads that wait for them.
  sigset_t all, before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  try {
    std::thread([queue = queue_] { queue->run(); }).detach();
    queue_->has_thread = true;
  } catch (const std::system_error&) {  // flush() writes
  }
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

LogWriter::~LogWriter() {
  const std::lock_guard lock(queue_->mutex);
  queue_->ended = true;
  queue_->wake.notify_one();
}

void LogWriter::log(const spdlog::details::log_msg& line) {
  const std::lock_guard formatting(formatting_);
  spdlog::memory_buf_t text;
  line.color_range_start = line.color_range_end = 0;
  formatter_->format(line, text);
  const auto from = line.color_range_start, to = line.color_range_end;
  const std::string_view colour = colours_ && to > from ? colour_of(line.level) : "";
  const std::string_view plain = colour.empty() ? "" : "\033[m";
  const std::lock_guard lock(queue_->mutex);
  auto& waiting = queue_->waiting;
  if (queue_->lost_behind > 0 || waiting.size() + colour.size() + text.size() + plain.size() > kMaxWaiting) {
    ++queue_->lost_behind;
    ++queue_->dropped;
    return;
  }
  append(waiting, text, 0, from);
  waiting += colour;
  append(waiting, text, from, to);
  waiting += plain;
  append(waiting, text, to, text.size());
  queue_->wake.notify_one();
}

void LogWriter::flush() {
  const auto until = Clock::now() + kPatience;
  std::unique_lock lock(queue_->mutex);
  if (!queue_->has_thread) {
    if (!queue_->waiting.empty() && !queue_->is_writing) queue_->write_batch(lock, until);
    return;
  }
  queue_->written.wait_until(lock, until, [this] { return queue_->waiting.empty() && !queue_->is_writing; });
}

void LogWriter::set_pattern(const std::string& pattern) {
  set_formatter(std::make_unique<spdlog::pattern_formatter>(pattern));
}

void LogWriter::set_formatter(std::unique_ptr<spdlog::formatter> formatter) {
  const std::lock_guard formatting(formatting_);
  formatter_ = std::move(formatter);
}

std::uint64_t LogWriter::dropped() const {
  const std::lock_guard lock(queue_->mutex);
  return queue_->dropped;
}

}  // namespace visum::programs
