// The log on a pipe: in order, whole lines, and without waiting for a reader. Nothing is asserted of how
// fast.
#include "server/programs/log_writer.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <spdlog/logger.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <vector>

namespace visum::programs {
namespace {

// A pipe that takes as little as the system allows.
class Pipe {
 public:
  Pipe() {
    if (::pipe2(ends_, O_CLOEXEC) != 0) throw std::runtime_error("pipe2");
    ::fcntl(ends_[1], F_SETPIPE_SZ, 4096);
  }
  ~Pipe() {
    close_reader();
    ::close(ends_[1]);
  }
  int writer() const { return ends_[1]; }
  void close_reader() {
    if (ends_[0] >= 0) ::close(ends_[0]);
    ends_[0] = -1;
  }
  // Reads until a line ends with `last`, or nothing comes for 10 s.
  std::vector<std::string> lines_up_to(const std::string& last) {
    std::string text;
    pollfd ready{ends_[0], POLLIN, 0};
    while (!text.ends_with(last + "\n") && ::poll(&ready, 1, 10'000) > 0) {
      char piece[512];
      const auto got = ::read(ends_[0], piece, sizeof piece);
      if (got <= 0) break;
      text.append(piece, static_cast<std::size_t>(got));
    }
    std::vector<std::string> lines;
    for (std::size_t from = 0, end = 0; (end = text.find('\n', from)) != text.npos; from = end + 1)
      lines.push_back(text.substr(from, end - from));
    return lines;
  }

 private:
  int ends_[2]{-1, -1};
};

std::unique_ptr<spdlog::logger> logger_on(const std::shared_ptr<LogWriter>& writer) {
  auto log = std::make_unique<spdlog::logger>("test", writer);
  log->set_pattern("test: %^%l%$: %v");
  return log;
}

TEST(LogWriter, WritesAllLinesInOrder) {
  Pipe pipe;
  const auto writer = std::make_shared<LogWriter>(pipe.writer(), "test", false);
  const auto log = logger_on(writer);
  for (int i = 0; i < 1000; ++i) log->warn("line {}", i);
  const auto lines = pipe.lines_up_to("line 999");
  ASSERT_EQ(lines.size(), 1000u);
  for (std::size_t i = 0; i < lines.size(); ++i)
    EXPECT_EQ(lines[i], "test: warning: line " + std::to_string(i));
  EXPECT_EQ(writer->dropped(), 0u);
}

TEST(LogWriter, DropsAndCountsWhatNobodyReadsAndSaysSoAfterwards) {
  Pipe pipe;
  const auto writer = std::make_shared<LogWriter>(pipe.writer(), "test", false);
  const auto log = logger_on(writer);
  constexpr std::size_t kLines = 20'000;
  const std::string text(100, 'x');
  for (std::size_t i = 0; i < kLines; ++i) log->warn("{}", text);
  const auto dropped = writer->dropped();
  EXPECT_GT(dropped, kLines / 2);
  EXPECT_LT(dropped, kLines);
  // The writer's thread may come to its turn at any time: then it is told in pieces, with lines between them
  // and behind the last one. A line that is not dropped ends it all.
  std::size_t written = 0, told = 0;
  const auto take = [&](const std::vector<std::string>& lines) {
    for (const auto& line : lines) {
      unsigned long long lost = 0;
      if (std::sscanf(line.c_str(), "test: warning: %llu lines of the log were dropped", &lost) == 1) {
        told += lost;
      } else if (line != "test: warning: afterwards") {
        EXPECT_EQ(line, "test: warning: " + text);
        ++written;
      }
    }
  };
  while (told < dropped) {
    const auto lines = pipe.lines_up_to(" lines of the log were dropped: nobody read it");
    ASSERT_FALSE(lines.empty());
    take(lines);
  }
  EXPECT_EQ(told, dropped);
  log->warn("afterwards");
  const auto rest = pipe.lines_up_to("afterwards");
  ASSERT_FALSE(rest.empty());
  EXPECT_EQ(rest.back(), "test: warning: afterwards");
  take(rest);
  EXPECT_EQ(written + told, kLines);
}

TEST(LogWriter, TheEndDoesNotWaitForAReader) {
  Pipe pipe;
  auto writer = std::make_shared<LogWriter>(pipe.writer(), "test", false);
  auto log = logger_on(writer);
  for (int i = 0; i < 10'000; ++i) log->warn("nobody reads this");
  log->flush();
  log.reset();
  writer.reset();
}

TEST(LogWriter, AFlushWaitsUntilTheLinesAreWritten) {
  Pipe pipe;
  const auto log = logger_on(std::make_shared<LogWriter>(pipe.writer(), "test", false));
  for (int i = 0; i < 20; ++i) {
    log->error("line {}", i);
    log->flush();
    EXPECT_EQ(pipe.lines_up_to("line " + std::to_string(i)).size(), 1u);
  }
}

TEST(LogWriter, AReaderThatIsGoneHoldsNothingUp) {
  Pipe pipe;
  pipe.close_reader();
  ::signal(SIGPIPE, SIG_IGN);
  const auto writer = std::make_shared<LogWriter>(pipe.writer(), "test", false);
  const auto log = logger_on(writer);
  for (int i = 0; i < 100; ++i) log->warn("line {}", i);
  log->flush();
  EXPECT_EQ(writer->dropped(), 0u);
}

TEST(LogWriter, ColoursTheLevelAlone) {
  Pipe pipe;
  const auto log = logger_on(std::make_shared<LogWriter>(pipe.writer(), "test", true));
  log->error("wrong");
  EXPECT_EQ(pipe.lines_up_to("wrong").at(0), "test: \033[31m\033[1merror\033[m: wrong");
}

}  // namespace
}  // namespace visum::programs
