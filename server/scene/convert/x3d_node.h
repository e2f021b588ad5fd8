// An X3D scene as a tree, apart from how it is written: as XML (.x3d), or in the classic encoding that it has
// from VRML97 (.x3dv, .wrl). ISO/IEC 19775-1 says what the nodes mean, 19776-1 and 19776-2 how they are
// written.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

namespace visum::scene {

struct X3dChild;

struct X3dNode {
  std::string type;  // "Transform"; empty where `use` is given
  std::string def, use;
  int line = 0;
  // Values by field, as XML attributes have them: "1 2 3", "true", a text, or several texts in quotes.
  std::map<std::string, std::string> values;
  std::vector<X3dChild> children;  // in their order

  X3dNode& add(const std::string& field, X3dNode child);
};

struct X3dChild {
  std::string field;
  X3dNode node;
};

inline X3dNode& X3dNode::add(const std::string& field, X3dNode child) {
  children.push_back({field, std::move(child)});
  return children.back().node;
}

// The top node has the type "Scene" and its nodes in the field "children". These throw ConfigError with file
// and line for what is not well-formed, for prototypes and scripts, and beyond the limits. No document types,
// no entities, no other file is ever opened.
X3dNode read_x3d_xml(const std::string& text, const std::string& file);
X3dNode read_x3d_classic(const std::string& text, const std::string& file);

std::string write_x3d_xml(const X3dNode& scene);
std::string write_x3d_classic(const X3dNode& scene, bool vrml97);

// What a field holds, where its text alone does not tell; for the classic encoding, which writes them
// differently.
bool is_text_field(const std::string& field);   // SFString
bool is_texts_field(const std::string& field);  // MFString
bool is_many_field(const std::string& field);   // MF of numbers or nodes

inline constexpr std::size_t kMaxX3dBytes = 16u << 20;
inline constexpr int kMaxX3dDepth = 64;
inline constexpr std::size_t kMaxX3dNodes = 100'000;

}  // namespace visum::scene
