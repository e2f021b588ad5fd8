// How far a campaign is: a line for a terminal, a page that renews itself, and a file by which the shards on
// other machines tell it. One thread.
#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>

namespace visum::campaign {

struct Progress {
  std::string what{};             // "search, "; empty: the campaign's own runs
  std::size_t done = 0, all = 0;  // of this shard; `done` counts those that were reused
  std::size_t passed = 0, failed = 0, invalid = 0, reused = 0;
};

// "12 of 200 runs, 1 failed, 0 invalid; 3.1 runs/s, about 60 s left". `seconds`: since the work began.
std::string progress_text(const Progress& progress, double seconds);
// FOLDER/report.html until the report is there. `clock`: the time of day, "18:28:07".
std::string progress_html(const std::string& name, const Progress& progress, double seconds,
                          const std::string& clock);

// Returns the progress that a shard has told, or its summary, if it is done. Nothing: it has not begun.
std::optional<Progress> read_progress(const std::filesystem::path& folder);

// Shows progress on stderr (often on a terminal, else every 10 s) and in FOLDER, every second.
class ProgressBoard {
 public:
  ProgressBoard(std::filesystem::path folder, std::string name);
  void show(const Progress& progress);
  void end();  // clears the terminal's line; removes the file

 private:
  using Clock = std::chrono::steady_clock;
  void write(const Progress& progress, double seconds) const;

  const std::filesystem::path folder_;
  const std::string name_;
  const bool terminal_;
  std::string what_;
  Clock::time_point began_ = Clock::now();
  std::optional<Clock::time_point> told_, written_;
};

}  // namespace visum::campaign
