#include "server/recording/replay.h"

#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <stdexcept>
#include <utility>

#include "server/cycle/apply_input.h"
#include "server/recording/recording_file.h"
#include "server/scene/scene.h"

namespace visum::recording {
namespace {

using Adjust = std::function<void(scene::Scene&)>;

std::unique_ptr<cycle::Simulation> make_world(const Header& header, const Adjust& adjust,
                                              const PluginFolders& plugins) {
  auto scene = scene::load_scene(header.scene_file, {header.engine, plugins, header.parameters});
  scene.seed = header.seed;
  if (adjust) adjust(scene);
  return std::make_unique<cycle::Simulation>(std::move(scene));
}

bool same_bits(double a, double b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

class Replayer {
 public:
  Replayer(const std::filesystem::path& file, const PluginFolders& plugins, const Adjust& adjust = {})
      : file_(file),
        files_(file_.take_files()),
        kept_(make_world(file_.header(), adjust, plugins)),
        world_(*kept_) {
    result_.header = file_.header();
  }

  Replay run(std::uint64_t ticks = std::numeric_limits<std::uint64_t>::max()) {
    while (result_.equal && result_.ticks < ticks) {
      const auto item = file_.next();
      if (std::holds_alternative<RecordingFile::End>(item)) break;
      if (const auto* input = std::get_if<const TimedInput*>(&item)) take(**input);
      if (const auto* sample = std::get_if<const protocol::PartSample*>(&item))
        samples_[(*sample)->part] = **sample;
      if (const auto* tick = std::get_if<const Tick*>(&item)) compare(**tick);
    }
    if (result_.equal) result_.damage = file_.damage();
    return std::move(result_);
  }
  Replay run_until(double at_s) {
    const double ticks = std::round(at_s * 1e9 / static_cast<double>(result_.header.tick_ns));
    return ticks < 1e18 ? run(static_cast<std::uint64_t>(ticks)) : run();
  }
  std::unique_ptr<cycle::Simulation> take_world() { return std::move(kept_); }

 private:
  void take(const TimedInput& input) {
    if (input.tick != world_.tick_count() || input.era != world_.era())
      return differ("an input that was taken at tick " + std::to_string(input.tick) + " of era " +
                    std::to_string(input.era));
    if (const auto reason = cycle::apply(world_, input.input); !reason.empty())
      return differ("an input is refused that was taken: " + reason);
    ++result_.inputs;
  }

  void compare(const Tick& tick) {
    if (world_.frozen()) return differ("the recorded world went on after it froze");
    world_.tick();
    result_.last_hash = world_.state_hash();
    result_.difference.recorded_hash = tick.state_hash;
    if (tick.tick != world_.tick_count() || tick.era != world_.era())
      return differ("the recorded tick is number " + std::to_string(tick.tick) + " of era " +
                    std::to_string(tick.era));
    if (tick.fault != world_.fault())
      return differ("the recorded world says '" + std::string(tick.fault) + "', this one '" + world_.fault() +
                    "'");
    if (tick.state_hash != result_.last_hash) {
      compare_ports();
      return differ("the state is another one");
    }
    ++result_.ticks;
  }

  void differ(const std::string& what) {
    result_.equal = false;
    auto& difference = result_.difference;
    difference.tick = world_.tick_count();
    difference.era = world_.era();
    difference.sim_time_ns = world_.sim_time_ns();
    difference.replayed_hash = world_.state_hash();
    difference.what = what;
  }

  void compare_ports() {
    for (const auto& bound : std::as_const(world_).parts()) {
      const auto& description = bound.part->description();
      const auto sample = samples_.find(description.name);
      if (sample == samples_.end() || sample->second.tick != world_.tick_count()) continue;
      compare_ports(description.name, description.controller_inputs, sample->second.controller_inputs,
                    bound.controller_inputs);
      compare_ports(description.name, description.sensor_outputs, sample->second.sensor_outputs,
                    bound.sensor_outputs);
    }
  }

  void compare_ports(const std::string& part, const std::vector<protocol::Port>& ports,
                     const std::vector<double>& recorded, const std::vector<double>& replayed) {
    auto& list = result_.difference.ports;
    for (std::size_t i = 0; i < ports.size() && i < recorded.size() && i < replayed.size(); ++i)
      if (!same_bits(recorded[i], replayed[i]) && list.size() < Difference::kMaxPorts)
        list.push_back({part, ports[i].name, recorded[i], replayed[i]});
  }

  RecordingFile file_;
  const config::FilesGiven files_;  // the world is made of these, not of what lies on the disk today
  std::unique_ptr<cycle::Simulation> kept_;
  cycle::Simulation& world_;
  std::map<std::string, protocol::PartSample> samples_;
  Replay result_;
};

}  // namespace

Replay replay(const std::filesystem::path& file, const PluginFolders& plugins) {
  return Replayer(file, plugins).run();
}

std::unique_ptr<cycle::Simulation> rewind(const std::filesystem::path& file, double at_s,
                                          const Adjust& adjust, const PluginFolders& plugins) {
  Replayer replayer(file, plugins, adjust);
  const auto result = replayer.run_until(at_s);
  if (!result.equal)
    throw std::runtime_error(file.string() + ": not the same bits at tick " +
                             std::to_string(result.difference.tick) + ": " + result.difference.what +
                             "; `visum replay` shows more");
  return replayer.take_world();
}

}  // namespace visum::recording
