// How every recording begins: the files of the scene, the header, the channels, and what each part is.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "protocol/config/read_file.h"
#include "protocol/recording/mcap_writer.h"
#include "server/cycle/simulation.h"

namespace visum::recording {

// What the scene was made of, beside itself.
struct Origin {
  config::Files files;       // all that was read for it
  std::string engine;        // instead of the scene's; empty: none
  std::string parameters{};  // of the scene's file, as scene::Options has them
  bool has_past = false;     // the world is not as the scene says: a recording of it begins with its state
};

// By their numbers in the file.
struct Channels {
  std::uint16_t inputs = 0, ticks = 0, states = 0, log = 0;
  std::vector<std::uint16_t> parts;
};

Channels write_beginning(McapWriter& writer, const cycle::Simulation& simulation, const Origin& origin);

}  // namespace visum::recording
