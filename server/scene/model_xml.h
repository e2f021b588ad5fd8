// Checks the XML of a model file before sdformat interprets it: it is well-formed, has no document types
// (entities), all numbers are finite and in range, all names exist, and the joints form a tree. tinyxml2
// stays inside these files.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

namespace visum::scene {

struct ModelXml {
  bool urdf = false;
  // The text for sdformat. A URDF is changed so that sdformat drops and joins nothing: fixed joints are
  // marked to be kept, links without a mass get one (see `massless`), and colours are scaled to undo
  // sdformat's own scaling.
  std::string text;
  std::vector<std::string> links, joints;  // in the order of the file; in nested SDF models as "inner::link"
  std::map<std::string, int> link_lines, joint_lines;
  std::set<std::string> massless;  // links to which the file gives no mass
  std::vector<std::string> losses;
};

inline constexpr std::size_t kMaxModelBytes = 16u << 20;

// Throws ConfigError with file, line, and the joint's or link's name.
ModelXml read_model_xml(const std::string& text, const std::string& file);

}  // namespace visum::scene
