#include "server/cycle/work_texts.h"

#include <optional>

namespace visum::cycle {
namespace {

constexpr std::size_t kMostNames = 8;

// The moving bodies of one engine, or of all.
std::string names_of(const world::WorldModel& model, std::optional<std::int32_t> engine) {
  std::string names;
  std::size_t count = 0;
  for (const auto& body : model.bodies) {
    if (body.fixed || (engine && body.engine != *engine)) continue;
    if (count < kMostNames) names += (count == 0 ? "" : ", ") + body.name;
    if (count++ == kMostNames) names += ", ...";
  }
  return names + " (" + std::to_string(count) + (count == 1 ? " body)" : " bodies)");
}

}  // namespace

std::vector<std::string> work_texts_of(const world::WorldModel& model) {
  std::vector<std::string> texts{"collisions of " + names_of(model, std::nullopt)};
  for (std::size_t i = 0; i < model.engines.size(); ++i)
    texts.push_back("engine '" + model.engines[i].name +
                    "': " + names_of(model, static_cast<std::int32_t>(i)));
  return texts;
}

}  // namespace visum::cycle
