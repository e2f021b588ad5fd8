// The XML of a model file, checked before anyone interprets it: well-formed, no document types (entities),
// every number finite and in range, names that exist, joints that form a tree. tinyxml2 stays inside these
// files.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

namespace visum::scene {

struct ModelXml {
  bool urdf = false;
  // For sdformat. A URDF is prepared so that nothing is dropped or joined on the way: fixed joints are marked
  // to be kept, links without a mass get one (see `massless`), colours are scaled against sdformat's own
  // scaling.
  std::string text;
  std::vector<std::string> links, joints;  // in the order of the file; nested SDF models as "inner::link"
  std::map<std::string, int> link_lines, joint_lines;
  std::set<std::string> massless;  // links whose file gives no mass
  std::vector<std::string> losses;
};

inline constexpr std::size_t kMaxModelBytes = 16u << 20;

// Throws ConfigError with file, line and the joint's or link's name.
ModelXml read_model_xml(const std::string& text, const std::string& file);

}  // namespace visum::scene
