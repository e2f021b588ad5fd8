// An X3D scene as a tree of nodes, independent of its encoding: XML (.x3d), or the classic encoding that
// comes from VRML97 (.x3dv, .wrl). ISO/IEC 19775-1 defines the nodes, 19776-1 and 19776-2 the encodings.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace visum::scene {

struct X3dChild;

struct X3dNode {
  std::string type;      // "Transform"; empty if `use` is set
  std::string def, use;  // in a copy of a prototype or file: name, kX3dMark, and its number
  int line = 0;
  // Values by field, in the form of XML attributes: "1 2 3", "true", a text, or several texts in quotes.
  std::map<std::string, std::string> values;
  std::vector<X3dChild> children;  // in the order of the file

  // Where it stands, if not in the file that was asked for: an inlined file, or one of prototypes.
  std::shared_ptr<const std::string> file = {};
  // Within a prototype's body: the prototype's field that gives a field its value ("IS").
  std::map<std::string, std::string> is = {};
  // The prototype that this node is an instance of, and the values of its fields. Once it is expanded, `type`
  // is that of the first node of the prototype's body.
  std::string prototype = {};
  std::map<std::string, std::string> given = {}, given_is = {};

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
// with file and line for text that is not well-formed, for scripts, and beyond the limits. Document types and
// entities are refused, and no other file is opened. Prototypes and Inline are left to x3d_prototypes.h:
//
//   ProtoDeclare, ExternProtoDeclare   def: its name; values: url
//     field "interface"                type "SFVec3f", def: the field's name, its default in "value"
//     field "body"                     the nodes of its body
//   an instance                        type and prototype: its name; in the classic encoding only the type
X3dNode read_x3d_xml(const std::string& text, const std::string& file);
X3dNode read_x3d_classic(const std::string& text, const std::string& file);

// The field in which a parent holds a node of this type, unless the file says otherwise.
std::string usual_x3d_field(const std::string& type, const std::string& parent);

std::string write_x3d_xml(const X3dNode& scene);
std::string write_x3d_classic(const X3dNode& scene, bool vrml97);

// The type of a field where its text alone does not show it. The classic encoding writes these types
// differently.
bool is_text_field(const std::string& field);   // SFString
bool is_texts_field(const std::string& field);  // MFString
bool is_many_field(const std::string& field);   // MF of numbers or nodes

inline constexpr char kX3dMark = '#';
inline constexpr std::size_t kMaxX3dBytes = 16u << 20;
inline constexpr int kMaxX3dDepth = 64;       // of a file
inline constexpr int kMaxX3dTreeDepth = 256;  // with prototypes, inlined files and USE written out
inline constexpr std::size_t kMaxX3dNodes = 100'000;

}  // namespace visum::scene
