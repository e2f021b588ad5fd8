// The table of the kinds of part, by name. It stands in a folder of its own, since it knows every kind while
// no kind knows it. A new kind is a folder in hwparts/ and one line in part_kinds.cc.
#pragma once

#include <memory>
#include <span>
#include <string>

#include "hwparts/part.h"

namespace visum::hwparts {

struct PartKind {
  const char* name;
  const char* help;
  // Throws ConfigError where the scene's entry is wrong.
  std::unique_ptr<Part> (*make)(const PartContext&);
  // The same part in front of real modules on a bus. Throws std::runtime_error where the modules on the bus
  // are not this part's.
  std::unique_ptr<Part> (*make_real)(const PartContext&, powercube::BusConnection&, const RealOptions&);
};
std::span<const PartKind> part_kinds();

// Both throw ConfigError at the entry's `kind` where the table has no such kind.
std::unique_ptr<Part> make_part(const std::string& kind, const PartContext& context);
std::unique_ptr<Part> make_real_part(const std::string& kind, const PartContext& context,
                                     powercube::BusConnection& line, const RealOptions& options);

}  // namespace visum::hwparts
