#include "server/programs/replay_report.h"

#include <cinttypes>
#include <cstdio>
#include <iostream>

#include "protocol/json_text.h"
#include "server/programs/program.h"
#include "server/recording/build.h"
#include "server/recording/replay.h"

namespace visum::programs {
namespace {

std::string hex(std::uint64_t number) {
  char text[24];
  std::snprintf(text, sizeof text, "%016" PRIx64, number);
  return text;
}

std::string exact(double number) {
  char text[32];
  std::snprintf(text, sizeof text, "%.17g", number);
  return text;
}

std::string seconds(std::int64_t ns) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3f s", static_cast<double>(ns) * 1e-9);
  return text;
}

// How the recording's build differs from this one. Another build may compute other bits, so a report of a
// difference names it.
std::string other_build(const recording::Replay& replay) {
  recording::Build here = recording::this_build({});
  return recording::difference(replay.header.build, here);
}

void print(const recording::Replay& replay) {
  std::cout << replay.header.scene << ": " << replay.ticks << " ticks with the same bits, " << replay.inputs
            << " inputs\n";
  if (const auto later = replay.ticks - replay.ticks_to_hash; later > 0)
    std::cout << "  the last " << later << " by their ports alone, as no hash of the state was recorded\n";
  if (!replay.equal) {
    const auto& at = replay.difference;
    std::cout << "DIFFERENT at tick " << at.tick << " of era " << at.era << " (" << seconds(at.sim_time_ns)
              << "): " << at.what << "\n";
    if (at.recorded_hash != recording::kNoHash)
      std::cout << "  state hash recorded " << hex(at.recorded_hash) << ", replayed " << hex(at.replayed_hash)
                << "\n";
    for (const auto& port : at.ports)
      std::cout << "  " << port.part << ": " << port.port << " recorded " << exact(port.recorded)
                << ", replayed " << exact(port.replayed) << "\n";
    if (at.ports.empty()) std::cout << "  no recorded port differs\n";
    if (const auto other = other_build(replay); !other.empty())
      std::cout << "  recorded by another build: " << other << "\n";
  }
  if (!replay.damage.empty())
    std::cout << "DAMAGED: the recording can be read only up to there: " << replay.damage << "\n";
}

void print_as_json(const recording::Replay& replay) {
  const auto& at = replay.difference;
  std::cout << "{\"equal\":" << (replay.equal ? "true" : "false") << ",\"ticks\":" << replay.ticks
            << ",\"ticks_to_hash\":" << replay.ticks_to_hash << ",\"inputs\":" << replay.inputs
            << ",\"state_hash\":" << protocol::json_quoted(hex(replay.last_hash))
            << ",\"damage\":" << protocol::json_quoted(replay.damage);
  if (!replay.equal) {
    std::string ports;
    for (const auto& port : at.ports)
      ports += (ports.empty() ? "" : ",") + std::string("{\"part\":") + protocol::json_quoted(port.part) +
               ",\"port\":" + protocol::json_quoted(port.port) +
               ",\"recorded\":" + protocol::json_quoted(exact(port.recorded)) +
               ",\"replayed\":" + protocol::json_quoted(exact(port.replayed)) + "}";
    std::cout << ",\"difference\":{\"tick\":" << at.tick << ",\"era\":" << at.era
              << ",\"sim_time_ns\":" << at.sim_time_ns << ",\"what\":" << protocol::json_quoted(at.what)
              << ",\"recorded_hash\":"
              << (at.recorded_hash == recording::kNoHash ? "null"
                                                         : protocol::json_quoted(hex(at.recorded_hash)))
              << ",\"replayed_hash\":" << protocol::json_quoted(hex(at.replayed_hash))
              << ",\"other_build\":" << protocol::json_quoted(other_build(replay)) << ",\"ports\":[" << ports
              << "]}";
  }
  std::cout << "}\n";
}

}  // namespace

int report_replay(const std::filesystem::path& file, const recording::PluginFolders& plugins, bool json) {
  const auto replay = recording::replay(file, plugins);
  json ? print_as_json(replay) : print(replay);
  if (!replay.equal) return kDiffers;
  return replay.damage.empty() ? kPassed : kFailed;
}

}  // namespace visum::programs
