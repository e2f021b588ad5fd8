// Reads the <surface> of SDF's collisions: see read_surfaces() in sdf_clean.h.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

#include "server/scene/sdf_clean.h"
#include "server/scene/sdf_include.h"

namespace visum::scene {
namespace {

constexpr double kMostFriction = 1e6;  // as world::find_fault wants it
constexpr double kSdfFriction = 1.0;   // where <friction> does not say it

// The element at a path below `from`; null if there is none.
const XMLElement* below(const XMLElement* from, std::initializer_list<const char*> path) {
  for (const char* tag : path) from = from ? from->FirstChildElement(tag) : nullptr;
  return from;
}

// The number at a path; nothing if it is not there or none.
std::optional<double> number_below(const XMLElement& from, std::initializer_list<const char*> path) {
  const XMLElement* element = below(&from, path);
  const auto all = element ? text_numbers(*element) : std::nullopt;
  return all && all->size() == 1 ? std::optional((*all)[0]) : std::nullopt;
}

void note_once(const XMLElement& element, const std::string& text, ModelXml& xml) {
  const bool told = std::ranges::any_of(xml.losses, [&](const Remark& loss) { return loss.text == text; });
  if (!told) xml.losses.push_back(remark(element, text));
}

// SDF's friction in the first and second direction; nothing if the file gives none.
std::optional<std::pair<double, double>> both_frictions(const XMLElement& friction) {
  auto mu = number_below(friction, {"ode", "mu"}), mu2 = number_below(friction, {"ode", "mu2"});
  if (!mu && !mu2) {
    mu = number_below(friction, {"bullet", "friction"});
    mu2 = number_below(friction, {"bullet", "friction2"});
  }
  const bool named =
      friction.FirstChildElement("ode") != nullptr || friction.FirstChildElement("bullet") != nullptr;
  if (!mu && !mu2 && !named) return std::nullopt;
  const double one = std::clamp(mu.value_or(kSdfFriction), 0.0, kMostFriction);
  return std::pair(one, std::clamp(mu2.value_or(one), 0.0, kMostFriction));
}

void read_torsional(const XMLElement& torsional, ModelSurface& to, ModelXml& xml) {
  const auto coefficient = number_below(torsional, {"coefficient"});
  const auto radius = number_below(torsional, {"patch_radius"});
  if (!coefficient) return;
  // A round patch with Hertz's pressure has torque = 3 pi / 16 * coefficient * radius * normal force.
  if (radius)
    to.torsional_friction =
        std::clamp(3.0 * std::numbers::pi / 16.0 * *coefficient * *radius, 0.0, kMostFriction);
  else
    note_once(torsional, "torsional friction acts only where its <patch_radius> is given", xml);
}

void read_friction(const XMLElement& surface, ModelSurface& to, ModelXml& xml) {
  const XMLElement* friction = surface.FirstChildElement("friction");
  if (friction == nullptr) return;
  if (const auto both = both_frictions(*friction)) {
    const auto [one, other] = *both;
    to.friction = one == other ? one : std::sqrt(one * other);
    if (one != other)
      note_once(*friction,
                "friction is the same in all directions: of <mu> and <mu2> the geometric mean acts", xml);
  }
  if (const XMLElement* torsional = friction->FirstChildElement("torsional"))
    read_torsional(*torsional, to, xml);
}

void note_unused(const XMLElement& surface, ModelXml& xml) {
  constexpr std::pair<const char*, const char*> kUnused[] = {{"contact", "kp"},       {"contact", "kd"},
                                                             {"contact", "soft_cfm"}, {"contact", "soft_erp"},
                                                             {"friction", "slip1"},   {"friction", "slip2"}};
  for (const auto& [group, name] : kUnused) {
    const auto number = number_below(surface, {group, "ode", name});
    if (number && *number != 0.0)
      note_once(*below(&surface, {group, "ode", name}),
                "<" + std::string(name) + "> is not read: contacts are hard, and stick up to their friction",
                xml);
  }
  const auto mask = text_of(below(&surface, {"contact", "collide_bitmask"}));
  if (!mask.empty() && mask != "65535" && mask != "0xffff" && mask != "0xFFFF")
    note_once(*below(&surface, {"contact", "collide_bitmask"}),
              "<collide_bitmask> is not read, unless it is 0: no_collision of the scene keeps bodies apart",
              xml);
}

bool passes_through(const XMLElement& surface) {
  const std::string mask = text_of(below(&surface, {"contact", "collide_bitmask"}));
  return is_true(below(&surface, {"contact", "collide_without_contact"})) ||
         (!mask.empty() && mask.find_first_not_of("0x") == std::string::npos);
}

}  // namespace

void read_surfaces(const XMLElement& link, const std::string& link_name, ModelXml& xml) {
  for (auto collision = link.FirstChildElement("collision"); collision;
       collision = collision->NextSiblingElement("collision")) {
    const XMLElement* surface = collision->FirstChildElement("surface");
    if (surface == nullptr || collision->Attribute("name") == nullptr) continue;
    ModelSurface read;
    read_friction(*surface, read, xml);
    if (const auto bounce = number_below(*surface, {"bounce", "restitution_coefficient"}))
      read.restitution = std::clamp(*bounce, 0.0, 1.0);
    if (passes_through(*surface)) {
      read.collides = false;
      note_once(*surface, "collisions without contact forces do not touch anything", xml);
    }
    note_unused(*surface, xml);
    xml.surfaces.emplace(std::pair(link_name, std::string(collision->Attribute("name"))), read);
  }
}

}  // namespace visum::scene
