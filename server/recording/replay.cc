#include "server/recording/replay.h"

#include <cmath>
#include <limits>
#include <stdexcept>

#include "server/recording/replayer.h"

namespace visum::recording {
namespace {

constexpr auto kAll = std::numeric_limits<std::uint64_t>::max();

std::uint64_t ticks_of(double seconds, std::int64_t tick_ns) {
  const double ticks = std::round(seconds * 1e9 / static_cast<double>(tick_ns));
  return ticks < 1e18 ? static_cast<std::uint64_t>(ticks) : kAll;
}

}  // namespace

Replay replay(const std::filesystem::path& file, const PluginFolders& plugins) {
  Replayer replayer(file, plugins);
  replayer.run(kAll);
  return replayer.result();
}

Rewound rewind(const std::filesystem::path& file, double at_s, const Adjust& adjust,
               const PluginFolders& plugins) {
  Replayer replayer(file, plugins, adjust);
  replayer.run(ticks_of(at_s, replayer.result().header.tick_ns));
  const auto& result = replayer.result();
  if (!result.equal)
    throw std::runtime_error(file.string() + ": not the same bits at tick " +
                             std::to_string(result.difference.tick) + ": " + result.difference.what +
                             "; `visum replay` shows more");
  return replayer.take_world();
}

}  // namespace visum::recording
