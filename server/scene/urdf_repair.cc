// Repairs of a URDF before it is checked: see repair_urdf() in xml_checks.h.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <optional>

#include "protocol/config/number_text.h"
#include "server/scene/inertia.h"
#include "server/scene/inertia_repair.h"
#include "server/scene/text_cursor.h"
#include "server/scene/xml_checks.h"

namespace visum::scene {
namespace {

constexpr double kLeastMassKg = 1e-9;  // a link of less has none: its shapes say what it weighs

// The numbers of an attribute; nothing if one of them is no finite number.
std::optional<std::vector<double>> numbers(const XMLElement& element, const char* attribute) {
  const char* text = element.Attribute(attribute);
  if (text == nullptr) return std::nullopt;
  std::vector<double> all;
  TextCursor cursor(text);
  for (std::string_view word = cursor.word(); !word.empty(); word = cursor.word()) {
    double number = 0.0;
    if (!parse_number(word, number) || !std::isfinite(number)) return std::nullopt;
    all.push_back(number);
  }
  return all;
}

std::optional<double> number(const XMLElement* element, const char* attribute) {
  if (element == nullptr) return std::nullopt;
  const auto all = numbers(*element, attribute);
  return all && all->size() == 1 ? std::optional((*all)[0]) : std::nullopt;
}

std::string named(const XMLElement& element) {
  const char* name = element.Attribute("name");
  return std::string(element.Name()) + " '" + (name ? name : "") + "'";
}

// The first attribute that gives a form sizes below kMinSizeM; null if none does. A negative size of a
// collision stays: that is a mistake, not a placeholder.
const char* tiny_size(const XMLElement& form, bool seen_only) {
  for (const char* attribute : {"size", "radius", "length", "scale"}) {
    if (form.Attribute(attribute) == nullptr) continue;
    const auto sizes = numbers(form, attribute);
    const bool is_scale = !std::strcmp(attribute, "scale");
    if (is_scale && !seen_only) continue;
    if (!sizes || sizes->empty()) {
      if (seen_only) return attribute;
      continue;
    }
    for (const double size : *sizes) {
      const bool tiny = is_scale ? size == 0.0 : size < kMinSizeM && (seen_only || size >= 0.0);
      if (tiny) return attribute;
    }
  }
  return nullptr;
}

// Takes out shapes of no size: they cannot be seen or touched.
void take_out_tiny_shapes(XMLElement& link, const char* tag, ModelXml& xml) {
  const bool seen_only = !std::strcmp(tag, "visual");
  for (XMLElement *shape = link.FirstChildElement(tag), *next = nullptr; shape; shape = next) {
    next = shape->NextSiblingElement(tag);
    const XMLElement* geometry = shape->FirstChildElement("geometry");
    const XMLElement* form = geometry ? geometry->FirstChildElement() : nullptr;
    const char* fault = form ? tiny_size(*form, seen_only) : nullptr;
    if (fault == nullptr) continue;
    const std::string text = std::string("a <") + tag + "> of " + named(link) + " is left out: its " +
                             form->Name() + " has the " + fault + " '" + form->Attribute(fault) + "'";
    (seen_only ? xml.losses : xml.repairs).push_back({text, form->GetLineNum()});
    link.DeleteChild(shape);
  }
}

bool is_good_color(const XMLElement& color) {
  const auto rgba = numbers(color, "rgba");
  return rgba && rgba->size() == 4 &&
         std::all_of(rgba->begin(), rgba->end(), [](double c) { return c >= 0; });
}

// Takes out colours that are none.
void take_out_bad_colors(XMLElement& element, ModelXml& xml) {
  for (XMLElement *child = element.FirstChildElement(), *next = nullptr; child; child = next) {
    next = child->NextSiblingElement();
    if (!std::strcmp(child->Name(), "color") && !is_good_color(*child)) {
      const char* rgba = child->Attribute("rgba");
      xml.losses.push_back({std::string("a <color> is not read: rgba must be 4 numbers of at least 0, is '") +
                                (rgba ? rgba : "") + "'",
                            child->GetLineNum()});
      element.DeleteChild(child);
    } else if (!std::strcmp(child->Name(), "visual") || !std::strcmp(child->Name(), "material")) {
      take_out_bad_colors(*child, xml);
    }
  }
}

std::optional<Eigen::Matrix3d> read_inertia(const XMLElement* inertia) {
  std::array<double, 6> m{};
  for (std::size_t i = 0; i < m.size(); ++i) {
    const auto moment = number(inertia, kMoments[i]);
    if (!moment) return std::nullopt;
    m[i] = *moment;
  }
  Eigen::Matrix3d matrix;
  matrix << m[0], m[3], m[4], m[3], m[1], m[5], m[4], m[5], m[2];
  return matrix;
}

void write_inertia(XMLElement& inertia, const Eigen::Matrix3d& matrix) {
  const std::array<double, 6> m{matrix(0, 0), matrix(1, 1), matrix(2, 2),
                                matrix(0, 1), matrix(0, 2), matrix(1, 2)};
  for (std::size_t i = 0; i < m.size(); ++i)
    inertia.SetAttribute(kMoments[i], config::number_text(m[i]).c_str());
}

void repair_inertia(XMLElement& link, XMLElement& inertial, ModelXml& xml) {
  XMLElement* element = inertial.FirstChildElement("inertia");
  const int line = element ? element->GetLineNum() : inertial.GetLineNum();
  const auto given = read_inertia(element);
  if (given && is_of_a_solid(*given, kMomentTolerance)) return;
  if (const auto solid = given ? as_solid(*given) : std::nullopt) {
    write_inertia(*element, *solid);
    xml.repairs.push_back(
        {named(link) + " has moments of inertia that no solid has (A + B < C): the smaller two are raised",
         line});
    return;
  }
  if (element) inertial.DeleteChild(element);
  xml.repairs.push_back(
      {named(link) + (given ? " has moments of inertia that are not positive" : " gives no full <inertia>") +
           ": its shapes say how its mass is spread",
       line});
}

// The numbers of a mass that are written badly stay: check_attributes() tells of them.
bool is_readable(const XMLElement& inertial) {
  for (auto child = inertial.FirstChildElement(); child; child = child->NextSiblingElement())
    for (auto a = child->FirstAttribute(); a; a = a->Next()) {
      const auto all = numbers(*child, a->Name());
      if (!all) return false;
    }
  const XMLElement* mass = inertial.FirstChildElement("mass");
  return mass == nullptr || number(mass, "value").value_or(-1.0) >= 0.0;
}

void repair_mass(XMLElement& link, ModelXml& xml) {
  XMLElement* inertial = link.FirstChildElement("inertial");
  if (inertial != nullptr && !is_readable(*inertial)) return;
  const double mass = inertial ? number(inertial->FirstChildElement("mass"), "value").value_or(0.0) : 0.0;
  if (mass > kLeastMassKg)
    repair_inertia(link, *inertial, xml);
  else if (inertial != nullptr)
    link.DeleteChild(inertial);
}

// A fixed joint uses its links and its origin only.
void strip_fixed_joint(XMLElement& joint) {
  for (const char* tag : {"axis", "limit", "dynamics", "mimic"})
    while (XMLElement* unused = joint.FirstChildElement(tag)) joint.DeleteChild(unused);
}

// Efforts and speeds that are no numbers count as none.
void clear_limit(XMLElement& joint, ModelXml& xml) {
  XMLElement* limit = joint.FirstChildElement("limit");
  if (limit == nullptr) return;
  for (const char* key : {"effort", "velocity"}) {
    if (number(limit, key).value_or(-1.0) >= 0.0) continue;
    if (const char* given = limit->Attribute(key))
      xml.losses.push_back({named(joint) + " has the " + key + " limit '" + given + "', which is not used",
                            limit->GetLineNum()});
    limit->DeleteAttribute(key);
  }
}

}  // namespace

void repair_urdf(XMLElement& root, ModelXml& xml) {
  take_out_bad_colors(root, xml);
  for (auto link = root.FirstChildElement("link"); link; link = link->NextSiblingElement("link")) {
    take_out_bad_colors(*link, xml);
    take_out_tiny_shapes(*link, "visual", xml);
    take_out_tiny_shapes(*link, "collision", xml);
    repair_mass(*link, xml);
  }
  for (auto joint = root.FirstChildElement("joint"); joint; joint = joint->NextSiblingElement("joint")) {
    if (!std::strcmp(joint->Attribute("type"), "fixed"))
      strip_fixed_joint(*joint);
    else
      clear_limit(*joint, xml);
  }
}

}  // namespace visum::scene
