// Checks an SDF file: see SdfDocument in sdf_expand.h.
#include <cmath>
#include <cstring>
#include <numbers>

#include "server/scene/sdf_clean.h"
#include "server/scene/sdf_expand.h"
#include "server/scene/sdf_include.h"

namespace visum::scene {
namespace {

// How many numbers the text of an element holds, and which.
struct TextRule {
  const char* element;
  std::size_t least, most;
  NumberRule rule;
};
// SDF elements whose text is numbers, wherever they stand.
constexpr TextRule kTexts[] = {
    {"pose", 0, 7, NumberRule::kAny},
    {"mass", 1, 1, NumberRule::kPositive},
    {"ixx", 1, 1, NumberRule::kNotNegative},
    {"iyy", 1, 1, NumberRule::kNotNegative},
    {"izz", 1, 1, NumberRule::kNotNegative},
    {"ixy", 1, 1, NumberRule::kAny},
    {"ixz", 1, 1, NumberRule::kAny},
    {"iyz", 1, 1, NumberRule::kAny},
    {"xyz", 3, 3, NumberRule::kNotZero},
    {"lower", 1, 1, NumberRule::kMayBeInfinite},
    {"upper", 1, 1, NumberRule::kMayBeInfinite},
    {"damping", 1, 1, NumberRule::kNotNegative},
    {"radius", 1, 1, NumberRule::kPositive},
    {"radii", 3, 3, NumberRule::kPositive},
    {"length", 1, 1, NumberRule::kPositive},
    {"size", 2, 3, NumberRule::kPositive},
    {"scale", 3, 3, NumberRule::kNoneZero},
    {"transparency", 0, 1, NumberRule::kNotNegative},
};

std::string name_in(const XMLElement& element) {
  return element.Attribute("name") ? element.Attribute("name") : "";
}

bool says(const char* word, const char* digit, const XMLElement* element) {
  const std::string text = text_of(element);
  return text == word || text == digit;
}

void note_link_losses(const XMLElement& link, const std::string& name, bool is_static, ModelXml& xml) {
  if (is_static) return;
  const XMLElement* inertial = link.FirstChildElement("inertial");
  if (!inertial)
    xml.losses.push_back(
        remark(link, "link '" + name + "' gives no <inertial>: SDF's 1 kg and 1 kg·m² are used if it moves"));
  else if (!inertial->FirstChildElement("inertia") && !inertial->Attribute("auto"))
    xml.losses.push_back(
        remark(*inertial, "link '" + name + "' gives no <inertia>: SDF's 1 kg·m² is used if it moves"));
  if (says("false", "0", link.FirstChildElement("gravity")))
    xml.losses.push_back(remark(
        link, "link '" + name + "' feels gravity like all others: a link without gravity is not simulated"));
  if (says("true", "1", link.FirstChildElement("kinematic")))
    xml.losses.push_back(
        remark(link, "link '" + name + "' is moved by forces like all others: <kinematic> is not simulated"));
}

// Reads the pitch of a screw, which has had two units, and notes couplings.
void read_joint_extras(const XMLElement& joint, const std::string& name, ModelXml& xml) {
  const auto number = [&](const char* tag) {
    const XMLElement* element = joint.FirstChildElement(tag);
    const auto all = element ? text_numbers(*element) : std::nullopt;
    return all && all->size() == 1 ? (*all)[0] : 0.0;
  };
  // thread_pitch is in rad/m, and positive for a left-handed thread.
  if (const double pitch = number("screw_thread_pitch"); pitch != 0.0)
    xml.pitches[name] = pitch;
  else if (const double turns = number("thread_pitch"); turns != 0.0)
    xml.pitches[name] = -2.0 * std::numbers::pi / turns;
  for (const char* tag : {"axis", "axis2"})
    if (const XMLElement* axis = joint.FirstChildElement(tag))
      if (const XMLElement* mimic = axis->FirstChildElement("mimic"))
        xml.losses.push_back(
            remark(*mimic, "joint '" + name + "' moves on its own: <mimic> is not simulated"));
}

void check_sdf_joint_type(const XMLElement& joint, const std::string& file) {
  const std::string type = joint.Attribute("type") ? joint.Attribute("type") : "";
  for (const char* known :
       {"revolute", "continuous", "prismatic", "fixed", "ball", "universal", "revolute2", "screw"})
    if (type == known) return;
  fail_at(joint, file,
          "joints of type '" + type +
              "' are not simulated (revolute, continuous, prismatic, fixed, ball, universal, revolute2 and "
              "screw are)");
}

// The model's own pose is ignored, because the scene's `pose` places the model's frame, as that of an
// <include> does.
void note_pose_loss(const XMLElement& model, ModelXml& xml) {
  const XMLElement* pose = model.FirstChildElement("pose");
  const auto numbers = pose ? text_numbers(*pose) : std::nullopt;
  bool moves = false;
  for (const double number : numbers.value_or(std::vector<double>{})) moves = moves || number != 0.0;
  if (moves)
    xml.losses.push_back(remark(*pose, "the model's own <pose> is not read: the scene's 'pose' places it"));
}

void take_place(const XMLElement& element, const std::string& name, std::vector<std::string>& names,
                std::map<std::string, int>& lines, ModelXml& xml) {
  names.push_back(name);
  const XmlPlace place = place_of(element);
  lines.emplace(name, place.line);
  if (!place.file.empty()) xml.files.emplace(name, place.file);
}

// Collects names with their places; links and joints of nested models as "inner::link".
void take_names(const XMLElement& model, const std::string& prefix, bool is_static, ModelXml& xml) {
  is_static = is_static || is_true(model.FirstChildElement("static"));
  for (auto child = model.FirstChildElement(); child; child = child->NextSiblingElement()) {
    if (child->Attribute("name") == nullptr) continue;
    const std::string name = prefix + name_in(*child);
    if (!std::strcmp(child->Name(), "link")) {
      take_place(*child, name, xml.links, xml.link_lines, xml);
      note_link_losses(*child, name, is_static, xml);
      read_surfaces(*child, name, xml);
    } else if (!std::strcmp(child->Name(), "joint")) {
      take_place(*child, name, xml.joints, xml.joint_lines, xml);
      read_joint_extras(*child, name, xml);
    } else if (!std::strcmp(child->Name(), "model")) {
      take_names(*child, name + "::", is_static, xml);
    }
  }
}

}  // namespace

void check_sdf_text(const XMLElement& element, const std::string& file) {
  for (const TextRule& rule : kTexts)
    if (!std::strcmp(rule.element, element.Name()))
      check_numbers(element, rule.element, element.GetText(), rule.least, rule.most, rule.rule, file);
}

SdfDocument::SdfDocument(tinyxml2::XMLDocument& document, const std::string& file, const Packages& packages)
    : expander_(document, file, packages, xml_), model_(expander_.expand()) {
  if (model_ == nullptr) return;  // a world without models
  if (!xml_.world) note_pose_loss(*model_, xml_);
  if (XMLElement* pose = model_->FirstChildElement("pose")) pose->DeleteAttribute("relative_to");
  take_names(*model_, "", false, xml_);
  take_out_unread(*model_, xml_);
  repair_sdf(*model_, file, xml_);
  const std::size_t elements = walk(
      *model_, [](const XMLElement&) { return false; },
      [&](const XMLElement& element) {
        if (!std::strcmp(element.Name(), "joint")) check_sdf_joint_type(element, file);
        check_sdf_text(element, file);
      });
  check_amount(elements, xml_, file);
}

}  // namespace visum::scene
