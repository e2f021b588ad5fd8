#include "server/scene/model_xml.h"

#include <cstring>

#include "protocol/config/config.h"
#include "server/scene/text_cursor.h"
#include "server/scene/xml_checks.h"

namespace visum::scene {
namespace {

// How many numbers the text of an element holds, and which.
struct TextRule {
  const char* element;
  std::size_t least, most;
  NumberRule rule;
};
// SDF elements whose text is numbers, wherever they stand. sdformat finds other errors.
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
    {"length", 1, 1, NumberRule::kPositive},
    {"size", 2, 3, NumberRule::kPositive},
    {"scale", 3, 3, NumberRule::kNoneZero},
    {"transparency", 0, 1, NumberRule::kNotNegative},
};

const std::vector<const char*> kUnread = {"sensor",       "plugin",     "light",   "particle_emitter",
                                          "audio_source", "audio_sink", "battery", "gripper",
                                          "surface",      "projector"};

bool is_unread(const XMLElement& element) {
  for (const char* name : kUnread)
    if (!std::strcmp(name, element.Name())) return true;
  return false;
}

void check_text(const XMLElement& element, const std::string& file) {
  for (const TextRule& rule : kTexts)
    if (!std::strcmp(rule.element, element.Name()))
      check_numbers(element, rule.element, element.GetText(), rule.least, rule.most, rule.rule, file);
}

bool says(const char* word, const char* digit, const XMLElement* element) {
  const std::string text = element && element->GetText() ? element->GetText() : "";
  return text == word || text == digit;
}

void note_link_losses(const XMLElement& link, const std::string& name, ModelXml& xml) {
  const XMLElement* inertial = link.FirstChildElement("inertial");
  if (!inertial)
    xml.losses.push_back(
        {"link '" + name + "' gives no <inertial>: SDF's 1 kg and 1 kg·m² are used if it moves",
         link.GetLineNum()});
  else if (!inertial->FirstChildElement("inertia"))
    xml.losses.push_back({"link '" + name + "' gives no <inertia>: SDF's 1 kg·m² is used if it moves",
                          inertial->GetLineNum()});
  if (says("false", "0", link.FirstChildElement("gravity")))
    xml.losses.push_back(
        {"link '" + name + "' feels gravity like all others: a link without gravity is not simulated",
         link.GetLineNum()});
  if (says("true", "1", link.FirstChildElement("kinematic")))
    xml.losses.push_back(
        {"link '" + name + "' is moved by forces like all others: <kinematic> is not simulated",
         link.GetLineNum()});
}

// The model's own pose is ignored, because the scene's `pose` places the model's frame, as that of an
// <include> does.
void note_pose_loss(const XMLElement& model, ModelXml& xml) {
  const XMLElement* pose = model.FirstChildElement("pose");
  if (!pose || !pose->GetText()) return;
  TextCursor cursor(pose->GetText());
  bool moves = false;
  for (std::string_view word = cursor.word(); !word.empty(); word = cursor.word()) {
    double number = 0.0;
    moves = moves || (parse_number(word, number) && number != 0.0);
  }
  if (moves)
    xml.losses.push_back(
        {"the model's own <pose> is not read: the scene's 'pose' places it", pose->GetLineNum()});
}

// Collects names with their lines; links and joints of nested models as "inner::link".
void take_names(const XMLElement& model, const std::string& prefix, ModelXml& xml) {
  for (const XMLElement* child = model.FirstChildElement(); child; child = child->NextSiblingElement()) {
    const char* attribute = child->Attribute("name");
    if (attribute == nullptr) continue;
    const std::string name = prefix + attribute;
    if (!std::strcmp(child->Name(), "link")) {
      xml.links.push_back(name);
      xml.link_lines.emplace(name, child->GetLineNum());
      note_link_losses(*child, name, xml);
    } else if (!std::strcmp(child->Name(), "joint")) {
      xml.joints.push_back(name);
      xml.joint_lines.emplace(name, child->GetLineNum());
    } else if (!std::strcmp(child->Name(), "model")) {
      take_names(*child, name + "::", xml);
    }
  }
}

// Document types can define entities, which can grow without bound or name other files.
void refuse_document_types(const tinyxml2::XMLDocument& document, const std::string& file) {
  for (const tinyxml2::XMLNode* node = document.FirstChild(); node; node = node->NextSibling())
    if (node->ToUnknown())
      throw config::ConfigError({file, node->GetLineNum(), ""},
                                "document types and entities (<!...>) are not supported");
}

std::string written(const tinyxml2::XMLDocument& document) {
  tinyxml2::XMLPrinter printer;
  document.Print(&printer);
  return printer.CStr();
}

std::string in_words(tinyxml2::XMLError error) {
  switch (error) {
    case tinyxml2::XML_ERROR_EMPTY_DOCUMENT:
      return "the file is empty";
    case tinyxml2::XML_ERROR_MISMATCHED_ELEMENT:
      return "an element is not closed, or by another one's name";
    case tinyxml2::XML_ERROR_PARSING_ELEMENT:
      return "an element is cut off or not well written";
    case tinyxml2::XML_ERROR_PARSING_ATTRIBUTE:
      return "an attribute is not well written";
    case tinyxml2::XML_ERROR_PARSING_TEXT:
      return "text stands outside of all elements";
    default:
      return tinyxml2::XMLDocument::ErrorIDToName(error);
  }
}

void parse(tinyxml2::XMLDocument& document, const std::string& text, const std::string& file) {
  if (text.find('\0') != std::string::npos)
    throw config::ConfigError({file, 0, ""}, "not valid XML: holds a zero byte");
  if (document.Parse(text.data(), text.size()) == tinyxml2::XML_SUCCESS) return;
  if (document.ErrorID() == tinyxml2::XML_ELEMENT_DEPTH_EXCEEDED)
    throw config::ConfigError({file, document.ErrorLineNum(), ""}, "XML elements are nested too deeply");
  throw config::ConfigError({file, document.ErrorLineNum(), ""},
                            "not valid XML: " + in_words(document.ErrorID()));
}

}  // namespace

void read_sdf(const XMLElement& root, const std::string& file, ModelXml& xml) {
  if (root.FirstChildElement("world"))
    fail_at(*root.FirstChildElement("world"), file,
            "holds a <world>: only a file with one <model> can be placed");
  const XMLElement* model = root.FirstChildElement("model");
  if (model == nullptr) fail_at(root, file, "has no <model>");
  if (const auto* second = model->NextSiblingElement("model"))
    fail_at(*second, file, "has more than one <model>");
  const std::size_t elements = walk(root, is_unread, [&](const XMLElement& element) {
    if (!std::strcmp(element.Name(), "include"))
      fail_at(element, file, "<include> is not read, place models in the scene");
    check_text(element, file);
  });
  note_pose_loss(*model, xml);
  take_names(*model, "", xml);
  check_amount(elements, xml, file);
  const auto unread = unread_elements(root, kUnread);
  xml.losses.insert(xml.losses.begin(), unread.begin(), unread.end());
}

ModelXml read_model_xml(const std::string& text, const std::string& file) {
  tinyxml2::XMLDocument document;
  parse(document, text, file);
  refuse_document_types(document, file);
  const XMLElement* root = document.RootElement();
  const std::string tag = root ? root->Name() : "";
  ModelXml xml;
  xml.urdf = tag == "robot";
  if (xml.urdf)
    read_urdf(document, file, xml);
  else if (tag == "sdf")
    read_sdf(*root, file, xml);
  else
    throw config::ConfigError(
        {file, root ? root->GetLineNum() : 0, ""},
        "is neither URDF (<robot>) nor SDF (<sdf>) nor MJCF (<mujoco>): its root is <" + tag + ">");
  xml.text = written(document);
  return xml;
}

}  // namespace visum::scene
