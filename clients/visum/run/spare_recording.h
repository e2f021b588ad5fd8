// A recording that is made for the case that a run fails. Until then it has a hidden name, so that it
// replaces no other recording: neither that of an earlier run nor that of a run beside it. One thread; the
// run owns it.
#pragma once

#include <filesystem>

namespace visum::run {

class SpareRecording {
 public:
  // Makes an empty file beside `wanted`. Throws std::system_error if that folder cannot be written to.
  explicit SpareRecording(std::filesystem::path wanted);
  ~SpareRecording();  // removes the file, unless it was kept
  SpareRecording(const SpareRecording&) = delete;
  SpareRecording& operator=(const SpareRecording&) = delete;

  const std::filesystem::path& path() const { return path_; }  // what the daemon writes
  // Gives it its name because the run failed; the daemon may still write it. Returns that name: `wanted`, or
  // if that is taken the first free one of "wanted_2", "wanted_3", ... Returns nothing if nothing was
  // recorded.
  std::filesystem::path keep();

 private:
  std::filesystem::path wanted_, path_, kept_;
};

}  // namespace visum::run
