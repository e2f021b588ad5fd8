#include "server/scene/sdf_clean.h"

#include <algorithm>
#include <cstring>
#include <map>
#include <set>

#include "protocol/config/number_text.h"
#include "server/scene/inertia.h"
#include "server/scene/inertia_repair.h"
#include "server/scene/sdf_include.h"

namespace visum::scene {
namespace {

using Names = std::set<std::string>;

// The children that are read of each element. Elements that are not listed are kept with all that they hold.
const std::map<std::string, Names>& read_children() {
  static const std::map<std::string, Names> known = {
      {"model", {"static", "self_collide", "pose", "frame", "link", "joint", "model"}},
      {"frame", {"pose"}},
      {"link", {"pose", "inertial", "collision", "visual", "self_collide"}},
      {"inertial", {"pose", "mass", "inertia"}},
      {"collision", {"pose", "geometry"}},
      {"visual", {"pose", "geometry", "material", "transparency"}},
      {"material", {"diffuse"}},
      {"joint", {"parent", "child", "pose", "axis", "axis2"}},
      {"axis", {"xyz", "limit", "dynamics", "use_parent_model_frame"}},
      {"axis2", {"xyz", "limit", "dynamics", "use_parent_model_frame"}},
  };
  return known;
}

// Those of the others that a user would miss, wherever they stand.
const std::vector<std::string> kMissed = {"sensor",
                                          "plugin",
                                          "light",
                                          "particle_emitter",
                                          "audio_source",
                                          "audio_sink",
                                          "battery",
                                          "gripper",
                                          "projector",
                                          "actor",
                                          "wind",
                                          "road",
                                          "population",
                                          "state",
                                          "fluid_added_mass"};

// Collects the elements that were taken out, in the order of kMissed.
class Missed {
 public:
  void note(const XMLElement& element) {
    const auto found = std::ranges::find(kMissed, element.Name());
    if (found == kMissed.end()) return;
    auto& [count, first] = counts_[static_cast<std::size_t>(found - kMissed.begin())];
    if (count++ == 0) first = place_of(element);
  }
  std::vector<Remark> remarks() const {
    std::vector<Remark> all;
    for (const auto& [index, counted] : counts_)
      all.push_back({std::to_string(counted.first) + " <" + kMissed[index] + "> element" +
                         (counted.first == 1 ? " is" : "s are") + " not read",
                     counted.second.line, counted.second.file});
    all.insert(all.end(), gearboxes.begin(), gearboxes.end());
    return all;
  }
  std::vector<Remark> gearboxes;

 private:
  std::map<std::size_t, std::pair<int, XmlPlace>> counts_;
};

// A fixed or ball joint uses no axis, and only a universal one has a second axis.
void take_out_unused_axes(XMLElement& joint) {
  const std::string type = joint.Attribute("type") ? joint.Attribute("type") : "";
  const auto take_out = [&](const char* tag) {
    while (XMLElement* axis = joint.FirstChildElement(tag)) joint.DeleteChild(axis);
  };
  if (type == "fixed" || type == "ball") take_out("axis");
  if (type != "universal" && type != "revolute2" && type != "gearbox") take_out("axis2");
}

// A gearbox couples two joints that are there without it.
void take_out_gearboxes(XMLElement& model, Missed& missed) {
  for (XMLElement *joint = model.FirstChildElement("joint"), *next = nullptr; joint; joint = next) {
    next = joint->NextSiblingElement("joint");
    const char* type = joint->Attribute("type");
    if (type == nullptr || std::strcmp(type, "gearbox") != 0) continue;
    missed.gearboxes.push_back(
        remark(*joint, "a joint of type gearbox couples nothing here: it is left out"));
    model.DeleteChild(joint);
  }
}

void strip(XMLElement& element, Missed& missed) {
  if (!std::strcmp(element.Name(), "joint")) take_out_unused_axes(element);
  take_out_gearboxes(element, missed);
  const auto read = read_children().find(element.Name());
  for (XMLElement *child = element.FirstChildElement(), *next = nullptr; child; child = next) {
    next = child->NextSiblingElement();
    if (read == read_children().end()) {
      missed.note(*child);
    } else if (read->second.count(child->Name()) == 0) {
      missed.note(*child);
      element.DeleteChild(child);
    } else {
      strip(*child, missed);
    }
  }
}

// Says what a shape's geometry lacks, by `check`. Empty if nothing.
std::string geometry_fault(const XMLElement& shape, const std::string& file) {
  const XMLElement* geometry = shape.FirstChildElement("geometry");
  if (geometry == nullptr || geometry->FirstChildElement() == nullptr) return "it has no form";
  if (geometry->FirstChildElement("empty") != nullptr) return "it is empty";
  try {
    walk(
        *geometry, [](const XMLElement&) { return false; },
        [&](const XMLElement& element) { check_sdf_text(element, file); });
  } catch (const config::ConfigError& error) {
    return error.message();
  }
  return "";
}

// True if a size of the form is too small to be touched. A negative one is a mistake.
bool is_tiny(const XMLElement& shape) {
  const XMLElement* form = shape.FirstChildElement("geometry")->FirstChildElement();
  if (form == nullptr) return false;
  for (const char* tag : {"size", "radius", "length"}) {
    const XMLElement* size = form->FirstChildElement(tag);
    const auto all = size ? text_numbers(*size) : std::nullopt;
    if (all && std::ranges::any_of(*all, [](double n) { return n >= 0.0 && n < kMinSizeM; })) return true;
  }
  return false;
}

std::string shape_named(const XMLElement& element) {
  const char* name = element.Attribute("name");
  return std::string(element.Name()) + " '" + (name ? name : "") + "'";
}

// Some models collide by points: spheres and boxes far smaller than the smallest shape here.
void enlarge_points(XMLElement& shape, ModelXml& xml) {
  XMLElement* geometry = shape.FirstChildElement("geometry");
  XMLElement* form = geometry ? geometry->FirstChildElement() : nullptr;
  for (const char* tag : {"size", "radius", "length"}) {
    XMLElement* size = form ? form->FirstChildElement(tag) : nullptr;
    const auto all = size ? text_numbers(*size) : std::nullopt;
    const auto is_point = [](double n) { return n > 0.0 && n < kMinSizeM; };
    if (!all || std::ranges::none_of(*all, is_point)) continue;
    std::string text;
    for (const double n : *all) text += config::number_text(is_point(n) ? kMinSizeM : n) + " ";
    xml.repairs.push_back(remark(*size, "the " + shape_named(shape) + " has the " + tag + " '" +
                                            text_of(size) + "': a micrometre is the least"));
    size->SetText(text.c_str());
  }
}

void clean_shapes(XMLElement& link, const char* tag, const std::string& file, ModelXml& xml) {
  const bool seen_only = !std::strcmp(tag, "visual");
  Names taken;
  for (XMLElement *shape = link.FirstChildElement(tag), *next = nullptr; shape; shape = next) {
    next = shape->NextSiblingElement(tag);
    if (!seen_only) enlarge_points(*shape, xml);
    const std::string fault = geometry_fault(*shape, file);
    const bool form_missing = fault == "it has no form" || fault == "it is empty";
    if (form_missing || (!fault.empty() && (seen_only || is_tiny(*shape)))) {
      const std::string text =
          "the " + shape_named(*shape) + " of " + shape_named(link) + " is left out: " + fault;
      (seen_only || form_missing ? xml.losses : xml.repairs).push_back(remark(*shape, text));
      link.DeleteChild(shape);
      continue;
    }
    const std::string name = shape->Attribute("name") ? shape->Attribute("name") : tag;
    std::string unique = name;
    for (int i = 1; !taken.insert(unique).second; ++i) unique = name + "_" + std::to_string(i);
    shape->SetAttribute("name", unique.c_str());  // by which its surface is found
  }
}

// A colour that is none is not shown.
void clean_colors(XMLElement& link, ModelXml& xml) {
  for (auto visual = link.FirstChildElement("visual"); visual;
       visual = visual->NextSiblingElement("visual")) {
    XMLElement* material = visual->FirstChildElement("material");
    XMLElement* diffuse = material ? material->FirstChildElement("diffuse") : nullptr;
    if (diffuse == nullptr) continue;
    const auto rgba = text_numbers(*diffuse);
    if (rgba && (rgba->size() == 3 || rgba->size() == 4) &&
        std::ranges::all_of(*rgba, [](double c) { return c >= 0.0; }))
      continue;
    xml.losses.push_back(remark(*diffuse, "the colour of " + shape_named(*visual) +
                                              " is not read: it must be 3 or 4 "
                                              "numbers of at least 0, is '" +
                                              text_of(diffuse) + "'"));
    material->DeleteChild(diffuse);
  }
}

void set_moment(XMLElement& inertia, const char* tag, double value) {
  XMLElement* element = inertia.FirstChildElement(tag);
  if (element == nullptr) element = inertia.InsertNewChildElement(tag);
  element->SetText(config::number_text(value).c_str());
}

std::optional<double> number_of(const XMLElement* parent, const char* tag, double otherwise) {
  const XMLElement* element = parent ? parent->FirstChildElement(tag) : nullptr;
  if (element == nullptr) return otherwise;
  const auto all = text_numbers(*element);
  return all && all->size() == 1 ? std::optional((*all)[0]) : std::nullopt;
}

void write_moments(XMLElement& inertia, const Eigen::Matrix3d& m) {
  for (std::size_t i = 0; i < kMoments.size(); ++i)
    set_moment(inertia, kMoments[i], m(kMomentPlaces[i].first, kMomentPlaces[i].second));
}

// The moments as the file gives them; SDF says 1 for those on the diagonal that it leaves out.
std::optional<Eigen::Matrix3d> read_moments(const XMLElement& inertia) {
  Eigen::Matrix3d m;
  for (std::size_t i = 0; i < kMoments.size(); ++i) {
    const auto [row, column] = kMomentPlaces[i];
    const auto moment = number_of(&inertia, kMoments[i], row == column ? 1.0 : 0.0);
    if (!moment) return std::nullopt;
    m(row, column) = m(column, row) = *moment;
  }
  return m;
}

void repair_link_mass(XMLElement& link, const std::string& name, ModelXml& xml) {
  XMLElement* inertial = link.FirstChildElement("inertial");
  if (inertial == nullptr) return;
  const char* automatic = inertial->Attribute("auto");
  const bool by_shapes = automatic && (!std::strcmp(automatic, "true") || !std::strcmp(automatic, "1"));
  const auto mass = number_of(inertial, "mass", 1.0);
  if (by_shapes || (mass && *mass == 0.0)) {
    xml.massless.insert(name);
    link.DeleteChild(inertial);
    return;
  }
  XMLElement* inertia = inertial->FirstChildElement("inertia");
  const auto given = inertia ? read_moments(*inertia) : std::nullopt;
  if (!given || is_of_a_solid(*given, kMomentTolerance)) return;
  if (const auto solid = as_solid(*given)) {
    write_moments(*inertia, *solid);
    xml.repairs.push_back(remark(*inertia, "link '" + name +
                                               "' has moments of inertia that no solid has (A + B < C): the "
                                               "smaller two are raised"));
    return;
  }
  xml.without_inertia.insert(name);
  write_moments(*inertia, Eigen::Matrix3d::Identity());
  xml.repairs.push_back(remark(*inertia, "link '" + name +
                                             "' has moments of inertia that are not positive: its shapes say "
                                             "how its mass is spread"));
}

void repair_model(XMLElement& model, const std::string& prefix, bool is_static, const std::string& file,
                  ModelXml& xml) {
  is_static = is_static || is_true(model.FirstChildElement("static"));
  for (auto link = model.FirstChildElement("link"); link; link = link->NextSiblingElement("link")) {
    const std::string name = prefix + (link->Attribute("name") ? link->Attribute("name") : "");
    clean_shapes(*link, "collision", file, xml);
    clean_shapes(*link, "visual", file, xml);
    clean_colors(*link, xml);
    if (is_static)
      while (XMLElement* inertial = link->FirstChildElement("inertial")) link->DeleteChild(inertial);
    else
      repair_link_mass(*link, name, xml);
  }
  for (auto inner = model.FirstChildElement("model"); inner; inner = inner->NextSiblingElement("model"))
    repair_model(*inner,
                 prefix + (inner->Attribute("name") ? inner->Attribute("name") : "") + "::", is_static, file,
                 xml);
}

}  // namespace

void take_out_unread(XMLElement& model, ModelXml& xml) {
  Missed missed;
  strip(model, missed);
  const auto remarks = missed.remarks();
  xml.losses.insert(xml.losses.begin(), remarks.begin(), remarks.end());
}

void repair_sdf(XMLElement& model, const std::string& file, ModelXml& xml) {
  // The outer model may be a world, whose models have names of their own.
  repair_model(model, "", false, file, xml);
}

}  // namespace visum::scene
