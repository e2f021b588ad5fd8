// A scenario that runs beside the world: a process of `visum run`, in a world of its own. A thread reads its
// lines and waits for its end, so that neither the tick nor the sessions wait for it.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "protocol/messages.h"
#include "protocol/processes/child_process.h"

namespace visum::gateway {

// Owned by ScenarioRequests, on whose thread the public functions are called. Nothing of it is left over: the
// destructor ends the process and all that it has started, and the kernel does so where this program is
// killed.
class ScenarioRun {
 public:
  using Clock = std::chrono::steady_clock;
  // News that wait; further ones are dropped and counted. Lines leave room for as many checks.
  static constexpr std::size_t kMostLines = 256, kMostNews = 2 * kMostLines;

  struct News {
    enum class Kind { kLine, kCheck, kEnd };
    Kind kind = Kind::kLine;
    std::string text{};                                                           // of a line, or of the end
    protocol::ScenarioCheck check{};                                              // kCheck
    protocol::ScenarioVerdict verdict = protocol::ScenarioVerdict::kUnspecified;  // from here: kEnd
    int exit_code = 0;
    std::uint64_t state_hash = 0;
  };

  // Starts `program` with `file`. Throws std::system_error where there is no thread for it. A program that
  // cannot be started is news.
  ScenarioRun(const std::filesystem::path& program, const std::filesystem::path& file,
              std::chrono::nanoseconds timeout);
  // Ends it; waits for two seconds at most before it kills.
  ~ScenarioRun();
  ScenarioRun(const ScenarioRun&) = delete;
  ScenarioRun& operator=(const ScenarioRun&) = delete;

  // Ends it in good order, and does not wait for that. It is killed if it takes more than ten seconds.
  void stop() { patience_.store(kFarewell); }
  // Moves the news into `news`. Returns how many lines were dropped since the last call. The last of all news
  // is kEnd; then the process has ended.
  std::uint64_t take(std::vector<News>& news);

 private:
  static constexpr std::chrono::milliseconds kFarewell{10'000}, kShortFarewell{2'000}, kNoEnd{0};

  void run();
  // Sends what ends the process, if that is due.
  void end_if_due(const processes::ChildProcess& child);
  void note(const std::string& line);
  void add(News news);
  News end_of(const processes::ChildProcess& child) const;

  const std::vector<std::string> words_;
  const Clock::time_point give_up_;
  const std::chrono::nanoseconds timeout_;
  std::atomic<std::chrono::milliseconds> patience_{kNoEnd};  // with which it is ended; kNoEnd: it is not

  // Used on the thread only.
  std::optional<Clock::time_point> ends_since_;
  bool too_late_ = false;      // its time was over
  std::optional<News> ended_;  // as the process itself has told
  std::string complaint_;      // its last line on stderr

  std::mutex mutex_;  // guards what follows
  std::vector<News> news_;
  std::uint64_t dropped_ = 0;

  std::thread thread_;  // last: it uses all others
};

}  // namespace visum::gateway
