// Writes the log to a descriptor that perhaps nobody reads. Lines wait in a bounded queue, and a thread of
// its own writes them. Whoever logs never waits for the reader: once the queue is full, further lines are
// dropped and counted, and the log says so where they are missing.
#pragma once

#include <spdlog/sinks/sink.h>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>

namespace visum::programs {

class LogWriter final : public spdlog::sinks::sink {
 public:
  static constexpr std::size_t kMaxWaiting = 256u << 10;  // bytes
  static constexpr std::chrono::milliseconds kPatience{1000};

  // `name` begins the line that says how many are missing. `colours`: the level of a line is coloured, for a
  // terminal. Where the system refuses another thread, flush() writes instead.
  LogWriter(int descriptor, const std::string& name, bool colours);
  // Does not wait, neither for the thread nor for the reader: call flush() first.
  ~LogWriter() override;

  // Any thread. Copies the line into memory that is there already.
  void log(const spdlog::details::log_msg& line) override;
  // Any thread. Waits until all lines are written, at most kPatience.
  void flush() override;
  void set_pattern(const std::string& pattern) override;
  void set_formatter(std::unique_ptr<spdlog::formatter> formatter) override;
  // The lines that were dropped since the start. Any thread.
  std::uint64_t dropped() const;

 private:
  struct Queue;

  const bool colours_;
  const std::shared_ptr<Queue> queue_;  // the thread holds it too, and may outlive us in a write that blocks
  std::mutex formatting_;
  std::unique_ptr<spdlog::formatter> formatter_;
};

}  // namespace visum::programs
