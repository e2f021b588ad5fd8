#include "server/recording/replay.h"

#include <spdlog/spdlog.h>

#include <charconv>
#include <cmath>
#include <limits>
#include <span>
#include <stdexcept>

#include "server/recording/replayer.h"
#include "server/world/world_state.h"

namespace visum::recording {
namespace {

constexpr auto kAll = std::numeric_limits<std::uint64_t>::max();

std::uint64_t ticks_of(double seconds, std::int64_t tick_ns) {
  const double ticks = std::round(seconds * 1e9 / static_cast<double>(tick_ns));
  return ticks < 1e18 ? static_cast<std::uint64_t>(ticks) : kAll;
}

// So many ticks in simulated seconds.
std::string place_of(const Replay& replay, std::uint64_t ticks) {
  const auto time_ns = static_cast<double>(ticks) * static_cast<double>(replay.header.tick_ns);
  char text[64];
  return {text, std::to_chars(text, text + sizeof text, time_ns / 1e9, std::chars_format::fixed).ptr};
}

void check_bits(const std::filesystem::path& file, const Replay& result) {
  if (result.equal) return;
  throw std::runtime_error(file.string() + ": not the same bits at tick " +
                           std::to_string(result.difference.tick) + ": " + result.difference.what +
                           "; the whole state is known to be the same up to " +
                           place_of(result, result.ticks_to_hash) + " s; `visum replay` shows more");
}

// The last ticks were compared by their ports alone. Another world goes on to where there is a hash, at most
// to the recording's end. A difference on the way there may have begun before.
void check_up_to_next_hash(const std::filesystem::path& file, const PluginFolders& plugins,
                           std::uint64_t ticks) {
  Replayer further(file, plugins);
  further.run(ticks);
  while (further.result().ticks_to_hash < ticks && further.run(1)) {
  }
  check_bits(file, further.result());
  if (further.result().ticks_to_hash < ticks)
    spdlog::warn("{}: its last {} ticks before that time have no hash; only their ports were compared",
                 file.string(), ticks - further.result().ticks_to_hash);
}

// Warns, or throws, where the recording ends before the tick that was asked for.
void check_reach(const std::filesystem::path& file, const Replay& replay, std::uint64_t asked) {
  if (replay.ticks >= asked) return;
  const auto place = place_of(replay, replay.ticks);
  if (replay.damage.empty()) {
    if (asked != kAll)
      spdlog::warn("{}: it ends at {} s; the world goes on from there", file.string(), place);
    return;
  }
  if (asked != kAll)
    throw std::runtime_error(file.string() + ": it can be read up to " + place + " s only: " + replay.damage);
  spdlog::warn("{}: it can be read up to {} s only, and the world goes on from there: {}", file.string(),
               place, replay.damage);
}

// The same state without the memories of its engines, which another engine could not read.
std::vector<std::byte> for_other_engines(std::span<const std::byte> bytes, const world::WorldModel& model) {
  world::WorldState state;
  std::string fault;
  const auto rest = world::load(bytes, model, state, fault);
  if (!fault.empty()) throw std::runtime_error(fault);
  for (auto& kept : state.engines) kept.clear();
  std::vector<std::byte> result;
  world::save(state, result);
  result.insert(result.end(), rest.begin(), rest.end());
  return result;
}

// Puts the state of the rewound world into `to`, the same world with another engine.
void hand_over(Rewound& rewound, std::unique_ptr<cycle::Simulation> to, const std::string& engine) {
  const config::FilesGiven given(rewound.origin.files);
  State whole;
  rewound.world->keep(whole);
  const auto& model = rewound.world->model();
  whole.state = for_other_engines(whole.state, model);
  for (auto& kept : whole.snapshots) kept.state = for_other_engines(kept.state, model);
  if (const auto outcome = to->restore(whole); !outcome.done())
    throw std::runtime_error("engine '" + engine + "' cannot go on from there: " + outcome.text());
  rewound.world = std::move(to);
  rewound.origin.engine = engine;
}

}  // namespace

Replay replay(const std::filesystem::path& file, const PluginFolders& plugins) {
  Replayer replayer(file, plugins);
  replayer.run(kAll);
  return replayer.result();
}

Rewound rewind(const std::filesystem::path& file, double at_s, const Adjust& adjust,
               const PluginFolders& plugins, const std::string& engine) {
  Replayer replayer(file, plugins, adjust);
  const auto asked = ticks_of(at_s, replayer.result().header.tick_ns);
  replayer.run(asked);
  const auto& result = replayer.result();
  check_bits(file, result);
  if (result.ticks_to_hash < result.ticks) check_up_to_next_hash(file, plugins, result.ticks);
  check_reach(file, result, asked);
  auto header = replayer.header();
  auto rewound = replayer.take_world();
  if (engine.empty()) return rewound;
  header.engine = engine;
  hand_over(rewound, make_world(header, rewound.origin.files, plugins, adjust), engine);
  return rewound;
}

}  // namespace visum::recording
