// The scenarios of the installation, which clients run by name, and the program that runs them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace visum::gateway {

inline constexpr std::size_t kMostScenarios = 1000;

// Names of the files NAME.yaml in the folder `scenarios` of the models' folder, sorted. Reads the folder.
std::vector<std::string> scenarios_in(const std::filesystem::path& models);
// Empty: there is none of that name. The name must be a plain one (plain_name.h).
std::filesystem::path scenario_file(const std::filesystem::path& models, const std::string& name);

// `visum`, beside this program. Never looked for elsewhere, since PATH is not the installation's.
std::filesystem::path scenario_program();

}  // namespace visum::gateway
