// Reads and writes X3D as XML with tinyxml2, which leaves entities and document types alone.
#include <tinyxml2.h>

#include <algorithm>
#include <cstring>
#include <map>

#include "protocol/config/config.h"
#include "server/scene/convert/x3d_node.h"

namespace visum::scene {
namespace {

using tinyxml2::XMLElement;

// The containerField of nodes that do not name one. All others go to "children".
const std::map<std::string, std::string>& usual_fields() {
  static const std::map<std::string, std::string> fields{{"Appearance", "appearance"},
                                                         {"Material", "material"},
                                                         {"Box", "geometry"},
                                                         {"Sphere", "geometry"},
                                                         {"Cylinder", "geometry"},
                                                         {"Cone", "geometry"},
                                                         {"IndexedFaceSet", "geometry"},
                                                         {"IndexedTriangleSet", "geometry"},
                                                         {"TriangleSet", "geometry"},
                                                         {"Coordinate", "coord"},
                                                         {"RigidBody", "bodies"},
                                                         {"SingleAxisHingeJoint", "joints"},
                                                         {"SliderJoint", "joints"},
                                                         {"BallJoint", "joints"},
                                                         {"UniversalJoint", "joints"},
                                                         {"DoubleAxisHingeJoint", "joints"},
                                                         {"MotorJoint", "joints"},
                                                         {"field", "field"},
                                                         {"CollisionCollection", "collider"},
                                                         {"MetadataString", "metadata"},
                                                         {"MetadataDouble", "metadata"},
                                                         {"MetadataSet", "metadata"},
                                                         {"MetadataFloat", "metadata"},
                                                         {"MetadataInteger", "metadata"},
                                                         {"MetadataBoolean", "metadata"}};
  return fields;
}

}  // namespace

std::string usual_x3d_field(const std::string& type, const std::string& parent) {
  if (type == "CollidableShape" || type == "CollidableOffset") {
    if (parent == "RigidBody") return "geometry";
    if (parent == "CollidableOffset") return "collidable";
  }
  if (type == "Shape" && parent == "CollidableShape") return "shape";
  const auto known = usual_fields().find(type);
  return known == usual_fields().end() ? "children" : known->second;
}

namespace {

class XmlReader {
 public:
  explicit XmlReader(std::string file) : file_(std::move(file)) {}

  X3dNode read(const std::string& text) {
    tinyxml2::XMLDocument document;
    refuse_document_type(text);
    if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS)
      fail(document.ErrorLineNum(), "not valid XML: " + std::string(document.ErrorName()));
    const XMLElement* root = document.RootElement();
    if (!root || std::strcmp(root->Name(), "X3D") != 0)
      fail(root ? root->GetLineNum() : 0, "the root element must be <X3D>");
    const XMLElement* scene = root->FirstChildElement("Scene");
    if (!scene) fail(root->GetLineNum(), "has no <Scene>");
    return node(*scene, 0);
  }

 private:
  [[noreturn]] void fail(int line, const std::string& message) const {
    throw config::ConfigError({file_, line, ""}, message);
  }

  // X3D files have one document type, which names the standard's own. A document type that declares anything
  // is refused.
  void refuse_document_type(const std::string& text) const {
    const std::size_t at = text.find("<!DOCTYPE");
    if (at == std::string::npos) return;
    const std::size_t end = text.find('>', at), bracket = text.find('[', at);
    if (bracket != std::string::npos && bracket < end)
      fail(static_cast<int>(1 +
                            std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n')),
           "a document type with declarations is not supported");
  }

  X3dNode node(const XMLElement& element, int depth) {
    if (depth > kMaxX3dDepth)
      fail(element.GetLineNum(), "nodes are nested more than " + std::to_string(kMaxX3dDepth) + " deep");
    if (++count_ > kMaxX3dNodes)
      fail(element.GetLineNum(), "has more than " + std::to_string(kMaxX3dNodes) + " nodes");
    X3dNode made;
    made.type = element.Name();
    made.line = element.GetLineNum();
    for (const auto* attribute = element.FirstAttribute(); attribute; attribute = attribute->Next())
      take(made, attribute->Name(), attribute->Value());
    for (const XMLElement* child = element.FirstChildElement(); child; child = child->NextSiblingElement()) {
      if (is_no_node(child->Name())) continue;
      if (!std::strcmp(child->Name(), "IS")) {
        connect(*child, made);
        continue;
      }
      made.add(field_of(*child, made.type), node(*child, depth + 1));
    }
    if (made.type == "ProtoInstance") to_instance(made);
    if (made.type == "ProtoDeclare" || made.type == "ExternProtoDeclare") to_declaration(made);
    return made;
  }

  // Empty for an instance that does not say it: the first node of its prototype decides.
  static std::string field_of(const XMLElement& element, const std::string& parent) {
    if (const char* field = element.Attribute("containerField")) return field;
    return std::strcmp(element.Name(), "ProtoInstance") ? usual_x3d_field(element.Name(), parent) : "";
  }

  // <IS><connect nodeField="center" protoField="middle"/></IS>
  void connect(const XMLElement& element, X3dNode& node) const {
    for (const XMLElement* one = element.FirstChildElement("connect"); one;
         one = one->NextSiblingElement("connect")) {
      const char *field = one->Attribute("nodeField"), *from = one->Attribute("protoField");
      if (!field || !from) fail(one->GetLineNum(), "<connect> needs nodeField and protoField");
      node.is[field] = from;
    }
  }

  std::string taken_name(X3dNode& node) const {
    const auto name = node.values.extract("name");
    if (name.empty()) fail(node.line, "<" + node.type + "> needs a name");
    return name.mapped();
  }

  void to_instance(X3dNode& node) const {
    node.prototype = taken_name(node);
    std::vector<X3dChild> values = std::move(node.children);
    node.children.clear();
    for (auto& [field, child] : values) {
      if (child.type != "fieldValue") continue;
      const std::string name = taken_name(child);
      if (const auto value = child.values.find("value"); value != child.values.end())
        node.values[name] = value->second;
      for (X3dChild& inner : child.children) node.add(name, std::move(inner.node));
    }
    node.type = node.prototype;
  }

  void to_declaration(X3dNode& node) const {
    node.def = taken_name(node);
    std::vector<X3dChild> parts = std::move(node.children);
    node.children.clear();
    for (auto& [field, part] : parts) {
      if (part.type == "ProtoBody")
        for (X3dChild& inner : part.children) node.add("body", std::move(inner.node));
      if (part.type == "field") node.add("interface", interface_field(std::move(part)));
      if (part.type == "ProtoInterface")
        for (X3dChild& inner : part.children)
          if (inner.node.type == "field") node.add("interface", interface_field(std::move(inner.node)));
    }
  }

  X3dNode interface_field(X3dNode field) const {
    field.def = taken_name(field);
    if (const auto type = field.values.find("type"); type != field.values.end()) field.type = type->second;
    for (X3dChild& child : field.children) child.field = "value";
    return field;
  }

  static void take(X3dNode& node, const std::string& name, const char* value) {
    if (name == "DEF")
      node.def = value;
    else if (name == "USE")
      node.use = value;
    else if (name != "containerField")
      node.values[name] = value;
  }

  static bool is_no_node(const char* name) {
    for (const char* other : {"ROUTE", "IMPORT", "EXPORT"})
      if (!std::strcmp(name, other)) return true;
    return false;
  }

  const std::string file_;
  std::size_t count_ = 0;
};

void write_node(tinyxml2::XMLPrinter& printer, const std::string& field, const X3dNode& node,
                const std::string& parent) {
  printer.OpenElement(node.type.c_str());
  if (!node.def.empty()) printer.PushAttribute("DEF", node.def.c_str());
  if (!node.use.empty()) printer.PushAttribute("USE", node.use.c_str());
  if (field != usual_x3d_field(node.type, parent)) printer.PushAttribute("containerField", field.c_str());
  for (const auto& [name, value] : node.values) printer.PushAttribute(name.c_str(), value.c_str());
  for (const auto& [name, child] : node.children) write_node(printer, name, child, node.type);
  printer.CloseElement();
}

}  // namespace

X3dNode read_x3d_xml(const std::string& text, const std::string& file) {
  return XmlReader(file).read(text);
}

std::string write_x3d_xml(const X3dNode& scene) {
  tinyxml2::XMLPrinter printer;
  printer.PushHeader(false, true);
  printer.OpenElement("X3D");
  printer.PushAttribute("profile", "Interchange");
  printer.PushAttribute("version", "3.2");
  printer.OpenElement("head");
  printer.OpenElement("component");
  printer.PushAttribute("name", "RigidBodyPhysics");
  printer.PushAttribute("level", "2");
  printer.CloseElement();
  printer.CloseElement();
  printer.OpenElement("Scene");
  for (const auto& [field, node] : scene.children) write_node(printer, field, node, scene.type);
  printer.CloseElement();
  printer.CloseElement();
  return printer.CStr();
}

}  // namespace visum::scene
