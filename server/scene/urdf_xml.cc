#include <algorithm>
#include <cstring>

#include "protocol/config/config.h"
#include "protocol/config/unknown_name.h"
#include "server/scene/model_errors.h"
#include "server/scene/xml_checks.h"

namespace visum::scene {
namespace {

// How many numbers an attribute holds, and which. Elements are checked wherever they stand.
struct AttributeRule {
  const char* element;
  const char* attribute;
  bool required;
  std::size_t count;
  NumberRule rule;
};
constexpr AttributeRule kAttributes[] = {
    {"origin", "xyz", false, 3, NumberRule::kAny},
    {"origin", "rpy", false, 3, NumberRule::kAny},
    {"axis", "xyz", true, 3, NumberRule::kNotZero},
    {"mass", "value", true, 1, NumberRule::kNotNegative},
    {"inertia", "ixx", true, 1, NumberRule::kNotNegative},
    {"inertia", "iyy", true, 1, NumberRule::kNotNegative},
    {"inertia", "izz", true, 1, NumberRule::kNotNegative},
    {"inertia", "ixy", true, 1, NumberRule::kAny},
    {"inertia", "ixz", true, 1, NumberRule::kAny},
    {"inertia", "iyz", true, 1, NumberRule::kAny},
    {"limit", "lower", false, 1, NumberRule::kAny},
    {"limit", "upper", false, 1, NumberRule::kAny},
    {"mimic", "multiplier", false, 1, NumberRule::kAny},
    {"mimic", "offset", false, 1, NumberRule::kAny},
    {"dynamics", "damping", false, 1, NumberRule::kNotNegative},
    {"dynamics", "friction", false, 1, NumberRule::kNotNegative},
    {"dynamics", "spring_stiffness", false, 1, NumberRule::kNotNegative},
    {"dynamics", "spring_reference", false, 1, NumberRule::kAny},
    {"box", "size", true, 3, NumberRule::kPositive},
    {"sphere", "radius", true, 1, NumberRule::kPositive},
    {"cylinder", "radius", true, 1, NumberRule::kPositive},
    {"cylinder", "length", true, 1, NumberRule::kPositive},
    {"capsule", "radius", true, 1, NumberRule::kPositive},
    {"capsule", "length", true, 1, NumberRule::kPositive},
    {"mesh", "scale", false, 3, NumberRule::kNoneZero},
    {"color", "rgba", true, 4, NumberRule::kNotNegative},
};

// These elements are not read; their subtrees may hold anything.
const std::vector<const char*> kUnread = {
    "gazebo", "transmission", "ros2_control", "sensor", "safety_controller", "calibration", "contact"};

bool is_unread(const XMLElement& element) {
  return std::any_of(kUnread.begin(), kUnread.end(),
                     [&](const char* n) { return !std::strcmp(n, element.Name()); });
}

void check_attribute(const XMLElement& element, const AttributeRule& rule, const std::string& file) {
  const char* text = element.Attribute(rule.attribute);
  if (text == nullptr && !rule.required) return;
  if (text == nullptr) required(element, rule.attribute, file);
  check_numbers(element, std::string(rule.element) + " " + rule.attribute, text, rule.count, rule.count,
                rule.rule, file);
}

void check_attributes(const XMLElement& element, const std::string& file,
                      std::vector<config::ConfigError>& errors) {
  for (const AttributeRule& rule : kAttributes)
    if (!std::strcmp(rule.element, element.Name()))
      keep_error(errors, [&] { check_attribute(element, rule, file); });
  if (!std::strcmp(element.Name(), "mesh")) keep_error(errors, [&] { required(element, "filename", file); });
}

double attribute_or(const XMLElement* element, const char* name, double otherwise) {
  return element == nullptr ? otherwise : element->DoubleAttribute(name, otherwise);
}

void check_joint_type(const XMLElement& joint, const std::string& file) {
  const std::string type = required(joint, "type", file);
  const std::vector<std::string> known = {"revolute", "continuous", "prismatic", "fixed", "floating"};
  if (std::find(known.begin(), known.end(), type) == known.end())
    fail_at(joint, file,
            "joints of type '" + type +
                "' are not simulated (revolute, continuous, prismatic, fixed, floating are)");
  if (type != "revolute" && type != "prismatic") return;
  const XMLElement* limit = joint.FirstChildElement("limit");
  if (limit == nullptr) fail_at(joint, file, "a " + type + " joint needs a <limit>");
}

std::string end_of(const XMLElement& joint, const char* tag, const ModelXml& xml, const std::string& file) {
  const XMLElement* end = joint.FirstChildElement(tag);
  if (end == nullptr) fail_at(joint, file, std::string("needs a <") + tag + ">");
  const std::string link = required(*end, "link", file);
  if (xml.link_lines.count(link) != 0) return link;
  fail_at(*end, file,
          std::string(tag) + " names link '" + link + "', which does not exist" +
              config::did_you_mean(link, xml.links));
}

// Refuses a name that is used twice, and remembers order and lines.
void take_name(const XMLElement& element, const std::string& file, std::vector<std::string>& names,
               std::map<std::string, int>& lines) {
  const std::string name = required(element, "name", file);
  const auto [first, is_new] = lines.try_emplace(name, element.GetLineNum());
  if (!is_new)
    fail_at(element, file, "there is already one of this name (line " + std::to_string(first->second) + ")");
  names.push_back(name);
}

// Checks that the joints form a tree: each link has at most one parent joint, one link has none, and all hang
// from it.
void check_tree(const XMLElement& root, const ModelXml& xml, const std::string& file) {
  std::map<std::string, std::string> parents;
  for (auto joint = root.FirstChildElement("joint"); joint; joint = joint->NextSiblingElement("joint")) {
    const std::string parent = end_of(*joint, "parent", xml, file),
                      child = end_of(*joint, "child", xml, file);
    if (parent == child) fail_at(*joint, file, "connects link '" + child + "' with itself");
    if (!parents.emplace(child, parent).second)
      fail_at(*joint, file, "link '" + child + "' hangs on another joint already: a URDF is a tree");
  }
  std::vector<std::string> roots;
  for (const std::string& link : xml.links)
    if (parents.count(link) == 0) roots.push_back(link);
  if (roots.empty()) fail_at(root, file, "the joints form a cycle: there is no root link");
  if (roots.size() > 1)
    fail_at(root, file, "has more than one root link: '" + roots[0] + "' and '" + roots[1] + "'");
  for (const std::string& link : xml.links) {
    std::string above = link;
    for (std::size_t steps = 0; parents.count(above) != 0; ++steps) {
      if (steps > xml.links.size()) fail_at(root, file, "the joints around link '" + link + "' form a cycle");
      above = parents[above];
    }
  }
}

// A root link called "world" is the world itself.
void take_out_world(const XMLElement& root, const std::string& file, ModelXml& xml) {
  const auto world = std::find(xml.links.begin(), xml.links.end(), "world");
  if (world == xml.links.end()) return;
  for (auto joint = root.FirstChildElement("joint"); joint; joint = joint->NextSiblingElement("joint"))
    if (!std::strcmp(joint->FirstChildElement("child")->Attribute("link"), "world"))
      fail_at(*joint, file, "link 'world' stands for the world: it cannot hang on a joint");
  for (auto link = root.FirstChildElement("link"); link; link = link->NextSiblingElement("link"))
    if (!std::strcmp(link->Attribute("name"), "world") && !link->NoChildren())
      xml.losses.push_back(
          {"link 'world' stands for the world: what it holds is not read", link->GetLineNum()});
  xml.links.erase(world);
}

void note_losses(const XMLElement& root, ModelXml& xml) {
  const auto unread = unread_elements(root, kUnread);
  xml.losses.insert(xml.losses.end(), unread.begin(), unread.end());
  for (auto joint = root.FirstChildElement("joint"); joint; joint = joint->NextSiblingElement("joint")) {
    const std::string type = joint->Attribute("type");
    const XMLElement* limit = joint->FirstChildElement("limit");
    if ((type == "revolute" || type == "prismatic") &&
        attribute_or(limit, "lower", 0) > attribute_or(limit, "upper", 0))
      xml.losses.push_back({"joint '" + std::string(joint->Attribute("name")) +
                                "' moves without limits: its lower limit is above the upper one",
                            limit->GetLineNum()});
  }
}

}  // namespace

ModelXml check_urdf(tinyxml2::XMLDocument& document, const std::string& file) {
  ModelXml xml;
  XMLElement& root = *document.RootElement();
  required(root, "name", file);
  std::vector<config::ConfigError> errors;
  for (auto link = root.FirstChildElement("link"); link; link = link->NextSiblingElement("link"))
    keep_error(errors, [&] { take_name(*link, file, xml.links, xml.link_lines); });
  if (xml.links.empty() && errors.empty()) fail_at(root, file, "has no link");
  const std::size_t elements = walk(root, is_unread, [](const XMLElement&) {});
  check_amount(elements, xml, file);
  for (auto joint = root.FirstChildElement("joint"); joint; joint = joint->NextSiblingElement("joint")) {
    keep_error(errors, [&] { take_name(*joint, file, xml.joints, xml.joint_lines); });
    keep_error(errors, [&] { check_joint_type(*joint, file); });
  }
  if (errors.empty()) repair_urdf(root, xml);
  walk(root, is_unread, [&](const XMLElement& element) { check_attributes(element, file, errors); });
  throw_all(std::move(errors));
  check_tree(root, xml, file);
  take_out_world(root, file, xml);
  note_losses(root, xml);
  return xml;
}

}  // namespace visum::scene
