#include "server/gateway/scene_check.h"

#include <iostream>

#include "server/cycle/simulation.h"
#include "server/gateway/json.h"

namespace visum::gateway {
namespace {

std::string counted(std::size_t number, const char* one, const char* many) {
  return std::to_string(number) + " " + (number == 1 ? one : many);
}

void print_right(const cycle::Simulation& simulation) {
  const auto& model = simulation.model();
  for (const auto& loss : simulation.scene().losses) std::cout << loss << "\n";
  std::cout << simulation.scene().file.string()
            << " is right: " << counted(model.bodies.size(), "body", "bodies") << ", "
            << counted(model.joints.size(), "joint", "joints") << ", "
            << counted(simulation.parts().size(), "part", "parts") << std::endl;
}

void print_right_as_json(const cycle::Simulation& simulation) {
  const auto& model = simulation.model();
  std::string losses;
  for (const auto& loss : simulation.scene().losses)
    losses += (losses.empty() ? "" : ",") + gateway::quoted(loss);
  std::cout << "{\"right\":true,\"scene\":" << gateway::quoted(model.name)
            << ",\"bodies\":" << model.bodies.size() << ",\"joints\":" << model.joints.size()
            << ",\"parts\":" << simulation.parts().size() << ",\"losses\":[" << losses << "]}" << std::endl;
}

void print_wrong_as_json(const config::ConfigError& error) {
  const auto& place = error.place();
  std::cout << "{\"right\":false,\"file\":" << gateway::quoted(place.file) << ",\"line\":" << place.line
            << ",\"key\":" << gateway::quoted(place.key)
            << ",\"message\":" << gateway::quoted(error.message()) << "}" << std::endl;
}

}  // namespace

void check_scene(const std::filesystem::path& file, const scene::Options& options, bool json) {
  try {
    const cycle::Simulation simulation(scene::load_scene(file, options));
    json ? print_right_as_json(simulation) : print_right(simulation);
  } catch (const config::ConfigError& error) {
    if (json) print_wrong_as_json(error);
    throw;
  }
}

}  // namespace visum::gateway
