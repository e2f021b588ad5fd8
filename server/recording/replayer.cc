#include "server/recording/replayer.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "server/cycle/apply_input.h"
#include "server/scene/convert/convert.h"
#include "server/scene/scene.h"
#include "server/world/world_state.h"

namespace visum::recording {
namespace {

bool same_bits(double a, double b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

// The places where the models' packages lay when the world was recorded: its files have names below them.
scene::Packages packages_of(const Header& header) {
  scene::Packages packages;
  for (const auto& [name, folder] : header.packages) packages.given[name] = folder;
  packages.folders.assign(header.package_folders.begin(), header.package_folders.end());
  return packages;
}

}  // namespace

std::unique_ptr<cycle::Simulation> make_world(const Header& header, const config::Files& files,
                                              const PluginFolders& plugins, const Adjust& adjust) {
  const config::FilesGiven given(files);
  auto scene =
      scene::load_any(header.scene_file, {header.engine, plugins, header.parameters, packages_of(header)});
  scene.seed = header.seed;
  if (adjust) adjust(scene);
  return std::make_unique<cycle::Simulation>(std::move(scene));
}

Header header_of(Header of_first, const LoadedScene& scene) {
  auto& header = of_first;
  header.scene = scene.name;
  header.scene_file = scene.file;
  header.engine = scene.engine;
  header.parameters = scene.parameters;
  header.seed = scene.seed;
  header.packages = scene.packages;
  header.package_folders = scene.package_folders;
  return header;
}

LoadedScene scene_of(const Header& header, config::Files files) {
  return {header.scene, header.scene_file, header.engine,          header.parameters,
          header.seed,  header.packages,   header.package_folders, std::move(files)};
}

void without_real_time(scene::Scene& scene) {
  scene.clock = scene::ClockKind::kFree;
}

Replayer::Replayer(const std::filesystem::path& file, const PluginFolders& plugins, const Adjust& adjust)
    : file_(file),
      header_(file_.header()),
      files_(file_.take_files()),
      kept_(make_world(header_, files_, plugins, adjust)),
      world_(*kept_) {
  result_.header = file_.header();
  begin();
}

// Reads ahead to the first record that is no description. A state is restored here and not in run(), which
// may come much later, or never.
void Replayer::begin() {
  const config::FilesGiven given(files_);
  do ahead_ = file_.next();
  while (std::holds_alternative<const protocol::PartDescription*>(*ahead_));
  if (std::holds_alternative<const State*>(*ahead_)) take(next());
}

RecordingFile::Item Replayer::next() {
  return ahead_ ? *std::exchange(ahead_, {}) : file_.next();
}

Rewound Replayer::take_world() {
  return {std::move(kept_),
          {std::move(files_), header_.engine, header_.parameters, true, packages_of(header_)}};
}

bool Replayer::run(std::uint64_t ticks) {
  const config::FilesGiven given(files_);
  const auto until = result_.ticks + std::min(ticks, UINT64_MAX - result_.ticks);
  while (!over_ && result_.ticks < until) {
    const auto item = next();
    if (std::holds_alternative<RecordingFile::End>(item)) {
      over_ = true;
      result_.damage = file_.damage();
    } else {
      take(item);
    }
  }
  note_last_hash();
  return !over_;
}

void Replayer::take(const RecordingFile::Item& item) {
  if (const auto* input = std::get_if<const TimedInput*>(&item)) take(**input);
  if (const auto* sample = std::get_if<const protocol::PartSample*>(&item))
    samples_[(*sample)->part] = **sample;
  if (const auto* tick = std::get_if<const Tick*>(&item)) compare(**tick);
  if (const auto* state = std::get_if<const State*>(&item)) take(**state);
}

// Inputs that come after the last tick do not count.
void Replayer::note_last_hash() {
  if (std::exchange(hash_is_noted_, true)) return;
  result_.last_hash = world_.state_hash();
}

void Replayer::take(const TimedInput& input) {
  begun_ = true;
  note_last_hash();
  if (input.tick != world_.tick_count() || input.era != world_.era())
    return differ("an input that was taken at tick " + std::to_string(input.tick) + " of era " +
                  std::to_string(input.era));
  if (const auto outcome = cycle::apply(world_, input.input); !outcome.done())
    return differ("an input is refused that was taken: " + outcome.text());
  if (const auto* loaded = std::get_if<LoadScene>(&input.input)) {
    header_ = header_of(std::move(header_), *loaded->scene);
    files_ = loaded->scene->files;
  }
  ++result_.inputs;
}

// A state at the beginning is restored. Later ones are compared, as ticks are.
void Replayer::take(const State& state) {
  if (begun_) {
    const auto hash = world::hash_bytes(state.state);
    if (hash != world_.state_hash()) return differ("the whole state is another one", hash);
    result_.ticks_to_hash = result_.ticks;
    return;
  }
  begun_ = true;
  if (const auto outcome = world_.restore(state); !outcome.done())
    differ("the state that it begins with cannot be restored: " + outcome.text());
}

void Replayer::compare(const Tick& tick) {
  begun_ = true;
  if (world_.frozen()) return differ("the recorded world went on after it froze");
  world_.tick();
  hash_is_noted_ = false;
  if (tick.tick != world_.tick_count() || tick.era != world_.era())
    return differ(
        "the recorded tick is number " + std::to_string(tick.tick) + " of era " + std::to_string(tick.era),
        tick.state_hash);
  if (tick.fault != world_.fault())
    return differ(
        "the recorded world says '" + std::string(tick.fault) + "', this one '" + world_.fault() + "'",
        tick.state_hash);
  const bool hashed = tick.state_hash != kNoHash;
  const bool same_state = !hashed || tick.state_hash == world_.state_hash();
  std::string without_ports;
  if (!hashed || !same_state) without_ports = compare_ports();
  if (!same_state) return differ("the state is another one", tick.state_hash);
  if (!result_.difference.ports.empty()) return differ("ports are others");
  if (!without_ports.empty()) return differ("the recording has not all ports of '" + without_ports + "'");
  ++result_.ticks;
  if (hashed) result_.ticks_to_hash = result_.ticks;
}

void Replayer::differ(const std::string& what, std::uint64_t recorded_hash) {
  over_ = true;
  result_.equal = false;
  auto& difference = result_.difference;
  difference.tick = world_.tick_count();
  difference.era = world_.era();
  difference.sim_time_ns = world_.sim_time_ns();
  difference.recorded_hash = recorded_hash;
  difference.replayed_hash = world_.state_hash();
  difference.what = what;
}

std::string Replayer::compare_ports() {
  std::string incomplete;
  for (const auto& bound : std::as_const(world_).parts()) {
    const auto& description = bound.part->description();
    const auto found = samples_.find(description.name);
    if (found == samples_.end() || found->second.tick != world_.tick_count() ||
        found->second.controller_inputs.size() != bound.controller_inputs.size() ||
        found->second.sensor_outputs.size() != bound.sensor_outputs.size()) {
      incomplete = description.name;
      continue;
    }
    compare_ports(description.name, description.controller_inputs, found->second.controller_inputs,
                  bound.controller_inputs);
    compare_ports(description.name, description.sensor_outputs, found->second.sensor_outputs,
                  bound.sensor_outputs);
  }
  return incomplete;
}

void Replayer::compare_ports(const std::string& part, const std::vector<protocol::Port>& ports,
                             const std::vector<double>& recorded, const std::vector<double>& replayed) {
  auto& list = result_.difference.ports;
  for (std::size_t i = 0; i < ports.size(); ++i)
    if (!same_bits(recorded[i], replayed[i]) && list.size() < Difference::kMaxPorts)
      list.push_back({part, ports[i].name, recorded[i], replayed[i]});
}

}  // namespace visum::recording
