#include "server/programs/scene_check.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <functional>
#include <iostream>
#include <optional>

#include "protocol/config/number_text.h"
#include "protocol/json_text.h"
#include "server/cycle/node_errors.h"
#include "server/cycle/simulation.h"
#include "server/cycle/start_overlaps.h"
#include "server/scene/all_errors.h"
#include "server/scene/convert/convert.h"

namespace visum::programs {
namespace {

constexpr std::size_t kMaxListed = 10;  // overlaps, without --json

std::string counted(std::size_t number, const char* one, const char* many) {
  return std::to_string(number) + " " + (number == 1 ? one : many);
}

// A short list, the deepest first.
void print_overlaps(const cycle::Simulation& simulation) {
  const auto& model = simulation.model();
  const auto overlaps = cycle::overlaps_at_start(model, simulation.prepared_meshes());
  for (std::size_t i = 0; i < std::min(overlaps.size(), kMaxListed); ++i)
    std::cout << "'" << model.bodies[overlaps[i].a.index()].name << "' and '"
              << model.bodies[overlaps[i].b.index()].name << "' overlap at the start by "
              << config::number_text(overlaps[i].depth_m) << " m\n";
  if (overlaps.size() > kMaxListed)
    std::cout << "and "
              << counted(overlaps.size() - kMaxListed, "further pair overlaps", "further pairs overlap")
              << " at the start\n";
}

std::string overlap_list(const cycle::Simulation& simulation) {
  const auto& model = simulation.model();
  std::string list;
  for (const auto& [a, b, depth_m] : cycle::overlaps_at_start(model, simulation.prepared_meshes()))
    list += (list.empty() ? "{\"a\":" : ",{\"a\":") + protocol::json_quoted(model.bodies[a.index()].name) +
            ",\"b\":" + protocol::json_quoted(model.bodies[b.index()].name) +
            ",\"depth_m\":" + config::number_text(depth_m) + "}";
  return "[" + list + "]";
}

void print_right(const cycle::Simulation& simulation) {
  const auto& model = simulation.model();
  for (const auto& loss : simulation.scene().losses) std::cout << loss << "\n";
  print_overlaps(simulation);
  std::cout << simulation.scene().file.string()
            << " is right: " << counted(model.bodies.size(), "body", "bodies") << ", "
            << counted(model.joints.size(), "joint", "joints") << ", "
            << counted(simulation.parts().size(), "part", "parts") << "\n";
}

// A list of objects with file, line and message.
std::string list_of(const std::vector<scene::FileRemark>& remarks) {
  std::string list;
  for (const auto& [file, remark] : remarks)
    list += (list.empty() ? "{\"file\":" : ",{\"file\":") + protocol::json_quoted(file) +
            ",\"line\":" + std::to_string(remark.line) +
            ",\"message\":" + protocol::json_quoted(remark.text) + "}";
  return "[" + list + "]";
}

// The joints that parts drive, part by part.
std::string actuated(const cycle::Simulation& simulation) {
  std::string list;
  for (const auto& part : simulation.scene().parts)
    for (const world::JointId joint : part.joints)
      list +=
          (list.empty() ? "" : ",") + protocol::json_quoted(simulation.model().joints[joint.index()].name);
  return "[" + list + "]";
}

void print_right_as_json(const cycle::Simulation& simulation) {
  const auto& model = simulation.model();
  std::string losses;
  for (const auto& loss : simulation.scene().losses)
    losses += (losses.empty() ? "" : ",") + protocol::json_quoted(loss);
  std::cout << "{\"right\":true,\"scene\":" << protocol::json_quoted(model.name)
            << ",\"bodies\":" << model.bodies.size() << ",\"joints\":" << model.joints.size()
            << ",\"parts\":" << simulation.parts().size() << ",\"tick_ns\":" << model.tick_ns
            << ",\"losses\":[" << losses << "],\"warnings\":" << list_of(simulation.scene().warnings)
            << ",\"repairs\":" << list_of(simulation.scene().repairs)
            << ",\"overlaps\":" << overlap_list(simulation) << ",\"actuated\":" << actuated(simulation)
            << "}\n";
}

// The members file, line, key and message of an error as JSON, after `before` and without the closing
// bracket.
std::string members_of(const config::ConfigError& error, const std::string& before) {
  const auto& place = error.place();
  return before + "\"file\":" + protocol::json_quoted(place.file) +
         ",\"line\":" + std::to_string(place.line) + ",\"key\":" + protocol::json_quoted(place.key) +
         ",\"message\":" + protocol::json_quoted(error.message());
}

// As load_any(). A file of X3D or VRML97 tells its first error only.
std::optional<scene::Scene> loaded(const std::filesystem::path& file, const scene::Options& options,
                                   std::vector<config::ConfigError>& errors) {
  if (!scene::is_x3d_file(file)) return scene::load_scene(file, options, errors);
  try {
    return scene::load_any(file, options);
  } catch (const config::ConfigError& error) {
    errors.push_back(error);
    return std::nullopt;
  }
}

// Returns the scene's errors. If there are none, shows the world that was made. Three stages follow each
// other: the file, the plug-ins' nodes, and the world with its engines; errors of one stage hide those of the
// next.
std::vector<config::ConfigError> errors_of(const std::filesystem::path& file, const scene::Options& options,
                                           const std::function<void(const cycle::Simulation&)>& show) {
  std::vector<config::ConfigError> errors;
  const auto scene = loaded(file, options, errors);
  if (!scene) return errors;
  errors = cycle::errors_of_nodes(*scene);
  if (!errors.empty()) return errors;
  try {
    show(cycle::Simulation(*scene));
  } catch (const config::ConfigError& error) {
    errors.push_back(error);
  }
  return errors;
}

}  // namespace

void print_wrong_as_json(const std::vector<config::ConfigError>& errors) {
  std::string list;
  for (const auto& error : errors) list += (list.empty() ? "" : ",") + members_of(error, "{") + "}";
  std::cout << members_of(errors.front(), "{\"right\":false,") << ",\"errors\":[" << list << "]}\n";
}

void check_scene(const std::filesystem::path& file, const scene::Options& options, bool json) {
  const auto errors = errors_of(file, options, [&](const cycle::Simulation& simulation) {
    json ? print_right_as_json(simulation) : print_right(simulation);
  });
  if (errors.empty()) return;
  if (json) print_wrong_as_json(errors);
  for (std::size_t i = 0; i + 1 < errors.size(); ++i) spdlog::error("{}", errors[i].what());
  throw errors.back();
}

void demand_right(const std::filesystem::path& file, const scene::Options& options) {
  const auto errors = errors_of(file, options, [](const cycle::Simulation&) {});
  if (!errors.empty()) throw errors.front();
}

}  // namespace visum::programs
