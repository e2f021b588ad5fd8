// An X3D scene as a tree of nodes, independent of its encoding: XML (.x3d), or the classic encoding that
// comes from VRML97 (.x3dv, .wrl). ISO/IEC 19775-1 defines the nodes, 19776-1 and 19776-2 the encodings.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

namespace visum::scene {

struct X3dChild;

struct X3dNode {
  std::string type;  // "Transform"; empty if `use` is set
  std::string def, use;
  int line = 0;
  // Values by field, in the form of XML attributes: "1 2 3", "true", a text, or several texts in quotes.
  std::map<std::string, std::string> values;
  std::vector<X3dChild> children;  // in the order of the file

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

// Readers. The top node has the type "Scene" and its nodes in the field "children". They throw ConfigError
// with file and line for text that is not well-formed, for prototypes and scripts, and beyond the limits.
// Document types and entities are refused, and no other file is opened.
X3dNode read_x3d_xml(const std::string& text, const std::string& file);
X3dNode read_x3d_classic(const std::string& text, const std::string& file);

std::string write_x3d_xml(const X3dNode& scene);
std::string write_x3d_classic(const X3dNode& scene, bool vrml97);

// The type of a field where its text alone does not show it. The classic encoding writes these types
// differently.
bool is_text_field(const std::string& field);   // SFString
bool is_texts_field(const std::string& field);  // MFString
bool is_many_field(const std::string& field);   // MF of numbers or nodes

inline constexpr std::size_t kMaxX3dBytes = 16u << 20;
inline constexpr int kMaxX3dDepth = 64;
inline constexpr std::size_t kMaxX3dNodes = 100'000;

}  // namespace visum::scene
