// A recording that is made for the case that a run fails. Until that is known it has a hidden name of its
// own, so that no other recording is lost by it: neither an earlier run's nor that of one beside it.
#pragma once

#include <filesystem>

namespace visum::run {

class SpareRecording {
 public:
  // Beside `wanted`. Throws std::system_error where nothing can be written there.
  explicit SpareRecording(std::filesystem::path wanted);
  ~SpareRecording();  // nobody kept it: it goes
  SpareRecording(const SpareRecording&) = delete;
  SpareRecording& operator=(const SpareRecording&) = delete;

  const std::filesystem::path& path() const { return path_; }  // what the daemon writes
  // The run failed: the name that it has from now on, also while it is still written: `wanted`, or where that
  // is taken the first free of "wanted_2", "wanted_3", ...; empty where nothing was recorded.
  std::filesystem::path keep();

 private:
  std::filesystem::path wanted_, path_, kept_;
};

}  // namespace visum::run
