#include "server/recording/archive.h"

#include <algorithm>
#include <fstream>
#include <ios>
#include <stdexcept>
#include <system_error>

#include "protocol/config/new_file.h"
#include "protocol/recording/recording_file.h"
#include "server/recording/build.h"

namespace visum::recording {
namespace {

// Tells what differs between the world of a snapshot and this one; empty: nothing that matters.
std::string what_differs(const Header& kept, const scene::Scene& scene, const Origin& origin) {
  if (const auto build = difference(kept.build, this_build(scene)); !build.empty())
    return "another build of visumd (" + build + ")";
  if (kept.seed != scene.seed) return "a world with another seed";
  if (kept.tick_ns != scene.world.tick_ns) return "a world with another tick";
  if (kept.engine != origin.engine) return "a world with another engine";
  if (kept.parameters != origin.parameters) return "a scene with other parameters";
  const bool same =
      std::ranges::equal(kept.files, origin.files, [](const FileEntry& entry, const auto& file) {
        return entry.name == file.first && entry.size == file.second.size() &&
               entry.crc == crc32(bytes_of(file.second));
      });
  return same ? "" : "another scene, '" + kept.scene + "', or its files have changed since";
}

void refuse(const std::error_code& error) {
  if (error) throw std::runtime_error("the server cannot read its folder for files: " + error.message());
}

bool is_there(const std::filesystem::path& file) {
  std::error_code error;
  const bool found = std::filesystem::exists(file, error);
  refuse(error);
  return found;
}

}  // namespace

void Archive::make_folder() const {
  std::error_code error;
  std::filesystem::create_directories(folder_, error);
  if (error) throw std::runtime_error("the server cannot make its folder for files: " + error.message());
}

void Archive::save(const cycle::Simulation& simulation, const std::string& name, const State& state) const {
  make_folder();
  std::size_t count = 0;
  std::error_code error;
  for (std::filesystem::directory_iterator at(folder_, error), end; !error && at != end; at.increment(error))
    count += at->path().string().ends_with(".snapshot.mcap");
  refuse(error);
  if (count >= kMostSnapshots && !is_there(snapshot_file(name)))
    throw std::runtime_error("the server keeps " + std::to_string(kMostSnapshots) + " snapshots already");
  try {
    const config::NewFile made(snapshot_file(name));
    std::ofstream out(made.path(), std::ios::binary | std::ios::trunc);
    out.exceptions(std::ios::failbit | std::ios::badbit);
    McapWriter writer(
        [&](Bytes bytes) {
          out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
        },
        "visumd");
    const auto channels = write_beginning(writer, simulation, origin_);
    std::vector<std::byte> bytes;
    encode(state, bytes);
    writer.write(channels.states, 0, 0, bytes);
    writer.close();
    out.close();
    made.keep();
  } catch (const std::ios_base::failure& error) {
    throw std::runtime_error("the snapshot cannot be written: " + error.code().message());
  }
}

State Archive::load(const cycle::Simulation& simulation, const std::string& name) const {
  if (!is_there(snapshot_file(name))) throw std::runtime_error("there is no snapshot '" + name + "'");
  RecordingFile file(snapshot_file(name));
  if (const auto other = what_differs(file.header(), simulation.scene(), origin_); !other.empty())
    throw std::runtime_error("the snapshot '" + name + "' is of " + other + ": it does not fit here");
  for (;;) {
    const auto item = file.next();
    if (const auto* state = std::get_if<const State*>(&item)) return **state;
    if (std::holds_alternative<RecordingFile::End>(item))
      throw std::runtime_error("the snapshot '" + name + "' is damaged: " + file.damage());
  }
}

std::unique_ptr<Recorder> Archive::record(cycle::Simulation& simulation, const std::string& name) const {
  make_folder();
  if (is_there(recording_file(name))) throw std::runtime_error("there is a recording '" + name + "' already");
  return Recorder::prepare(simulation, origin_, recording_file(name));
}

}  // namespace visum::recording
