// Writes down what happens in a world: everything that it takes between ticks, and after each tick every port
// and the hash of its state, in a file that holds all that is needed to go through it again. Lives on the
// tick's thread and never holds it up; the file is written by a thread of its own (scribe.h).
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "protocol/config/read_file.h"
#include "protocol/recording/records.h"
#include "server/cycle/simulation.h"

namespace visum::recording {

class Scribe;

// What the scene was made of, beside itself.
struct Origin {
  config::Files files;       // all that was read for it
  std::string engine;        // instead of the scene's; empty: none
  std::string parameters{};  // of the scene's file, as scene::Options has them
};

class Recorder : public cycle::Witness {
 public:
  // From now on, which has to be before the first tick and the first input. Throws std::runtime_error where
  // the file cannot be written.
  Recorder(cycle::Simulation& simulation, const Origin& origin, const std::filesystem::path& file);
  ~Recorder() override;  // finishes the file

  void took(const TimedInput& input) override;
  void ticked() override;
  void log(std::string_view level, std::string_view text);  // any thread

 private:
  void write_beginning(const Origin& origin);
  void put(std::uint16_t channel);  // what stands in bytes_

  cycle::Simulation& simulation_;
  const std::unique_ptr<Scribe> scribe_;
  std::uint16_t inputs_ = 0, ticks_ = 0, log_ = 0;  // channels
  std::vector<std::uint16_t> parts_;                // channels, by part
  std::uint64_t time_ns_ = 0;                       // of all ticks so far, in all eras
  std::vector<std::byte> bytes_;
};

}  // namespace visum::recording
