#include "server/programs/scene_convert.h"

#include <iostream>

#include "protocol/json_text.h"
#include "server/programs/scene_check.h"
#include "server/scene/convert/convert.h"

namespace visum::programs {
namespace {

void print(const std::filesystem::path& to, const std::vector<std::string>& losses) {
  for (const auto& loss : losses) std::cout << loss << "\n";
  std::cout << to.string() << " is written" << (losses.empty() ? "" : ", without what is listed above")
            << "\n";
}

void print_as_json(const std::filesystem::path& to, const std::vector<std::string>& losses) {
  std::string list;
  for (const auto& loss : losses) list += (list.empty() ? "" : ",") + protocol::json_quoted(loss);
  std::cout << "{\"written\":" << protocol::json_quoted(to.string()) << ",\"losses\":[" << list << "]}\n";
}

// The file that was written must pass `visum check`.
void demand_readable(const std::filesystem::path& to, const scene::Options& options) {
  scene::Options for_it = options;
  for_it.parameters.clear();
  try {
    demand_right(to, for_it);
  } catch (const config::ConfigError& error) {
    throw config::ConfigError(error.place(), "is written, but cannot be read again: " + error.message());
  }
}

}  // namespace

bool convert_scene(const std::filesystem::path& from, const std::filesystem::path& to,
                   const scene::Options& options, bool json) {
  try {
    const auto losses = scene::convert(from, to, options);
    demand_readable(to, options);
    json ? print_as_json(to, losses) : print(to, losses);
    return losses.empty();
  } catch (const config::ConfigError& error) {
    if (json) print_wrong_as_json({error});
    throw;
  }
}

}  // namespace visum::programs
