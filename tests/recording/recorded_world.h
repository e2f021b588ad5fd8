// A world with a robot that is recorded while a test works on it.
#pragma once

#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <string>
#include <vector>

#include "server/recording/recorder.h"
#include "server/scene/scene.h"
#include "tests/support/temp_files.h"

namespace visum::recording {

inline constexpr const char* kBall =
    "{name: ball, mass: 0.5, pose: {xyz: [0.6, 0.5, 1.0]}, shapes: [{sphere: 0.05}]}";

class RecordedWorld {
 public:
  explicit RecordedWorld(const std::string& scene = "two_link.yaml", const std::string& engine = {}) {
    config::FilesNoted noted;
    auto loaded =
        scene::load_scene(std::filesystem::path(VISUM_SOURCE_DIR) / "models/scenes" / scene, {engine});
    loaded.clock = scene::ClockKind::kLockstep;
    simulation_.emplace(std::move(loaded));
    recorder_.emplace(*simulation_, Origin{std::move(noted.files), engine}, file());
  }

  cycle::Simulation& operator*() { return *simulation_; }
  cycle::Simulation* operator->() { return &*simulation_; }
  Recorder& recorder() { return *recorder_; }
  void run(int ticks) {
    for (int i = 0; i < ticks; ++i) simulation_->tick();
  }
  // Ends the recording in good order, or as one that is cut after its last tick.
  std::filesystem::path finish(bool in_good_order = true) {
    if (in_good_order) recorder_->end();
    recorder_.reset();
    return file();
  }
  std::filesystem::path file() const { return files_.folder() / "run.mcap"; }
  const test::TempFiles& files() const { return files_; }

 private:
  test::TempFiles files_;
  std::optional<cycle::Simulation> simulation_;
  std::optional<Recorder> recorder_;
};

inline std::string bytes_of_file(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace visum::recording
