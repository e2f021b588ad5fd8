#include "server/scene/sdf_expand.h"

#include <cmath>
#include <cstring>
#include <set>

#include "protocol/config/number_text.h"
#include "protocol/config/read_file.h"
#include "server/scene/sdf_include.h"

namespace visum::scene {
namespace {

namespace fs = std::filesystem;

constexpr int kMaxDepth = 16;
constexpr std::size_t kMaxCopied = 100'000;  // elements of all included files
constexpr const char* kWorldModel = "visum_world";

double version_of(const XMLElement& sdf) {
  return sdf_version(sdf.Attribute("version") ? sdf.Attribute("version") : "");
}

void move_attribute(XMLElement& element, const char* from, const char* to) {
  const char* value = element.Attribute(from);
  if (value == nullptr) return;
  if (*value != '\0' && element.Attribute(to) == nullptr) element.SetAttribute(to, value);
  element.DeleteAttribute(from);
}

// Rewrites what old versions say in another way than SDF 1.9: the frames of poses and axes.
void modernise(XMLElement& element, double version) {
  for (auto child = element.FirstChildElement(); child; child = child->NextSiblingElement()) {
    const std::string tag = child->Name();
    if (tag == "pose" && version < 7) move_attribute(*child, "frame", "relative_to");
    if ((tag == "axis" || tag == "axis2") && version < 7) {
      XMLElement* flag = child->FirstChildElement("use_parent_model_frame");
      XMLElement* xyz = child->FirstChildElement("xyz");
      if (xyz != nullptr && (version < 5 || is_true(flag))) xyz->SetAttribute("expressed_in", "__model__");
      if (flag != nullptr) child->DeleteChild(flag);
    }
    modernise(*child, version);
  }
}

bool is_frame(const XMLElement& element) {
  const std::string tag = element.Name();
  return tag == "link" || tag == "joint" || tag == "frame" || tag == "model";
}

// A name that SDF 1.9 allows: not "world", and no scope in it.
std::string allowed_name(std::string name) {
  for (std::size_t at = name.find("::"); at != std::string::npos; at = name.find("::"))
    name.replace(at, 2, "__");
  return name == "world" || (name.size() > 4 && name.starts_with("__") && name.ends_with("__")) ? name + "_1"
                                                                                                : name;
}

void replace_name(XMLElement& element, const char* attribute,
                  const std::map<std::string, std::string>& names) {
  const char* value = element.Attribute(attribute);
  const auto renamed = value ? names.find(value) : names.end();
  if (renamed != names.end()) element.SetAttribute(attribute, renamed->second.c_str());
}

// Before version 1.8 names could be what later versions reserve. They are renamed here, with their uses.
void rename_reserved(XMLElement& model, double version, ModelXml& xml) {
  if (version >= 8) return;
  std::map<std::string, std::string> renamed;
  for (auto child = model.FirstChildElement(); child; child = child->NextSiblingElement()) {
    const std::string name = child->Attribute("name") ? child->Attribute("name") : "";
    if (!is_frame(*child) || allowed_name(name) == name) continue;
    renamed[name] = allowed_name(name);
    xml.losses.push_back(remark(*child, std::string(child->Name()) + " '" + name + "' is called '" +
                                            renamed[name] + "' here: SDF reserves its name"));
    child->SetAttribute("name", renamed[name].c_str());
  }
  for (auto child = model.FirstChildElement(); child; child = child->NextSiblingElement()) {
    if (!std::strcmp(child->Name(), "model")) rename_reserved(*child, version, xml);
    if (renamed.empty()) continue;
    for (const char* tag : {"parent", "child"})
      if (XMLElement* end = child->FirstChildElement(tag))
        if (const auto found = renamed.find(text_of(end)); found != renamed.end())
          end->SetText(found->second.c_str());
    replace_name(*child, "attached_to", renamed);
    if (XMLElement* pose = child->FirstChildElement("pose")) replace_name(*pose, "relative_to", renamed);
  }
}

void rename(XMLElement& element, const char* attribute, const char* from, const std::string& to) {
  const char* value = element.Attribute(attribute);
  if (value == nullptr || std::strcmp(value, from) != 0) return;
  if (to.empty())
    element.DeleteAttribute(attribute);
  else
    element.SetAttribute(attribute, to.c_str());
}

// Replaces a child by a copy of `given`, or takes it out if that is null.
void set_child(XMLElement& element, const char* tag, const XMLElement* given) {
  if (given == nullptr) return;
  while (XMLElement* old = element.FirstChildElement(tag)) element.DeleteChild(old);
  element.InsertFirstChild(given->DeepClone(element.GetDocument()));
}

// The first number is gravity's or the step's; nothing if it is not written well.
void read_world_settings(const XMLElement& world, ModelXml& xml) {
  const XMLElement* physics = world.FirstChildElement("physics");
  const XMLElement* gravity = world.FirstChildElement("gravity");
  if (gravity == nullptr && physics != nullptr) gravity = physics->FirstChildElement("gravity");
  const auto g = gravity ? text_numbers(*gravity) : std::nullopt;
  if (g && g->size() == 3) xml.world->gravity = Eigen::Vector3d((*g)[0], (*g)[1], (*g)[2]);
  const XMLElement* step = physics ? physics->FirstChildElement("max_step_size") : nullptr;
  const auto s = step ? text_numbers(*step) : std::nullopt;
  if (s && s->size() == 1) xml.world->step_s = (*s)[0];
}

bool has_links(const XMLElement& model) {
  if (model.FirstChildElement("link") != nullptr) return true;
  for (auto inner = model.FirstChildElement("model"); inner; inner = inner->NextSiblingElement("model"))
    if (has_links(*inner)) return true;
  return false;
}

// A world may hold models without links, as a plug-in's home.
void take_out_empty_models(XMLElement& parent, ModelXml& xml) {
  for (XMLElement *model = parent.FirstChildElement("model"), *next = nullptr; model; model = next) {
    next = model->NextSiblingElement("model");
    if (has_links(*model)) {
      take_out_empty_models(*model, xml);
      continue;
    }
    const char* name = model->Attribute("name");
    xml.losses.push_back(remark(*model, std::string("model '") + (name ? name : "") + "' has no link"));
    parent.DeleteChild(model);
  }
}

}  // namespace

XMLElement* SdfExpander::expand() {
  XMLElement& root = *document_.RootElement();
  const std::string version = root.Attribute("version") ? root.Attribute("version") : "";
  if (!version.starts_with("1."))
    fail_at(root, file_, "the version must be one of SDF 1, such as 1.9, is '" + version + "'");
  if (XMLElement* world = root.FirstChildElement("world")) return world_as_model(*world);
  modernise(root, version_of(root));
  for (auto model = root.FirstChildElement("model"); model; model = model->NextSiblingElement("model"))
    rename_reserved(*model, version_of(root), xml_);
  for (XMLElement *child = root.FirstChildElement("include"), *next = nullptr; child; child = next) {
    next = child->NextSiblingElement("include");
    include(*child, root, file_, 0);
  }
  XMLElement* model = root.FirstChildElement("model");
  if (model == nullptr) fail_at(root, file_, "has no <model>");
  if (const auto* second = model->NextSiblingElement("model"))
    fail_at(*second, file_, "has more than one <model>");
  expand_model(*model, file_, 0);
  take_out_empty_models(*model, xml_);
  if (!has_links(*model)) fail_at(*model, file_, "has no <link>");
  return model;
}

XMLElement* SdfExpander::world_as_model(XMLElement& world) {
  XMLElement& root = *document_.RootElement();
  xml_.world.emplace();
  in_world_ = true;
  if (const auto* second = world.NextSiblingElement("world"))
    xml_.losses.push_back(remark(*second, "only the first <world> of the file is read"));
  for (XMLElement *child = root.FirstChildElement(), *next = nullptr; child; child = next) {
    next = child->NextSiblingElement();
    if (child != &world) root.DeleteChild(child);
  }
  modernise(world, version_of(root));
  rename_reserved(world, version_of(root), xml_);
  read_world_settings(world, xml_);
  expand_model(world, file_, 0);
  for (const char* tag : {"model", "frame"})
    for (auto child = world.FirstChildElement(tag); child; child = child->NextSiblingElement(tag)) {
      rename(*child, "attached_to", "world", "");
      if (XMLElement* pose = child->FirstChildElement("pose")) rename(*pose, "relative_to", "world", "");
    }
  take_out_empty_models(world, xml_);
  make_names_unique(world);
  world.SetName("model");
  world.SetAttribute("name", kWorldModel);
  return world.FirstChildElement("model") != nullptr ? &world : nullptr;
}

// Worlds of old versions may hold two models of one name.
void SdfExpander::make_names_unique(XMLElement& world) {
  std::set<std::string> taken;
  for (auto model = world.FirstChildElement("model"); model; model = model->NextSiblingElement("model")) {
    const std::string name = model->Attribute("name") ? model->Attribute("name") : "";
    std::string unique = name.empty() || name == "world" ? name + "model" : name;
    for (int i = 1; !taken.insert(unique).second; ++i) unique = name + "_" + std::to_string(i);
    if (unique == name) continue;
    model->SetAttribute("name", unique.c_str());
    xml_.losses.push_back(remark(*model, "a model named '" + name + "' is called '" + unique + "' here"));
  }
}

void SdfExpander::expand_model(XMLElement& model, const std::string& file, int depth) {
  for (XMLElement *child = model.FirstChildElement(), *next = nullptr; child; child = next) {
    next = child->NextSiblingElement();
    if (!std::strcmp(child->Name(), "include"))
      include(*child, model, file, depth);
    else if (!std::strcmp(child->Name(), "model"))
      expand_model(*child, file, depth);
  }
}

// Replaces an <include> by the model that it names.
void SdfExpander::include(XMLElement& include, XMLElement& parent, const std::string& file, int depth) {
  if (depth >= kMaxDepth)
    fail_at(include, file_,
            "files include each other over more than " + std::to_string(kMaxDepth) + " levels");
  const std::string uri = text_of(include.FirstChildElement("uri"));
  if (uri.empty()) fail_at(include, file_, "<include> needs a <uri>");
  const fs::path path = find(include, uri, file);
  if (path.empty()) {
    const std::string fault = uri.find("://") != std::string::npos && uri.find("model://") != 0
                                  ? "nothing is fetched from a network; download the model, and name its "
                                    "folder in the <uri>"
                                  : "no such model beside the file or in the folders above it; name its "
                                    "folder with --package NAME=PATH or in GZ_SIM_RESOURCE_PATH";
    return leave_out(include, parent, "'" + uri + "': " + fault);
  }
  const Source& source = open(path, include);
  const XMLElement* wanted = source.document->RootElement()->FirstChildElement("model");
  if (wanted == nullptr) {
    xml_.losses.push_back(remark(include, "<include> is left out: '" + uri + "' holds no <model>"));
    parent.DeleteChild(&include);
    return;
  }
  XMLElement* model = copy(*wanted, source.file);
  modernise(*model, source.version);
  rename_reserved(*model, source.version, xml_);
  // The place of the original: the element that is left out may be the last one of its kind.
  parent.InsertAfterChild(&include, model);
  if (const std::string name = text_of(include.FirstChildElement("name")); !name.empty())
    model->SetAttribute("name", name.c_str());
  if (const std::string frame = text_of(include.FirstChildElement("placement_frame")); !frame.empty())
    model->SetAttribute("placement_frame", frame.c_str());
  set_child(*model, "pose", include.FirstChildElement("pose"));
  set_child(*model, "static", include.FirstChildElement("static"));
  expand_model(*model, source.file, depth + 1);
  const char* merged = include.Attribute("merge");
  if (merged != nullptr && (!std::strcmp(merged, "true") || !std::strcmp(merged, "1"))) merge(*model, parent);
  parent.DeleteChild(&include);
}

// Moves what a model holds into another one. Poses that were relative to the model are then relative to a
// frame in its place.
void SdfExpander::merge(XMLElement& model, XMLElement& into) {
  const std::string frame =
      std::string("_merged_") + (model.Attribute("name") ? model.Attribute("name") : "");
  if (model.Attribute("placement_frame") != nullptr)
    fail_at(model, file_, "<placement_frame> of a merged <include> is not read: give the pose of its model");
  XMLElement* place = document_.NewElement("frame");
  place->SetAttribute("name", frame.c_str());
  into.InsertAfterChild(&model, place);
  if (XMLElement* pose = model.FirstChildElement("pose")) place->InsertEndChild(pose);
  const std::set<std::string> moved = {"link", "joint", "frame", "model"};
  tinyxml2::XMLNode* last = place;
  for (XMLElement *child = model.FirstChildElement(), *next = nullptr; child; child = next) {
    next = child->NextSiblingElement();
    const std::string tag = child->Name();
    if (moved.count(tag) == 0) continue;
    XMLElement* pose = child->FirstChildElement("pose");
    if (pose != nullptr) rename(*pose, "relative_to", "__model__", frame);
    if (tag == "frame") {
      rename(*child, "attached_to", "__model__", frame);
      if (child->Attribute("attached_to") == nullptr) child->SetAttribute("attached_to", frame.c_str());
    }
    if (tag == "link" || tag == "model") {
      if (pose == nullptr) pose = child->InsertNewChildElement("pose");
      if (pose->Attribute("relative_to") == nullptr) pose->SetAttribute("relative_to", frame.c_str());
    }
    for (const char* axis : {"axis", "axis2"})
      if (XMLElement* found = child->FirstChildElement(axis))
        if (XMLElement* xyz = found->FirstChildElement("xyz"))
          rename(*xyz, "expressed_in", "__model__", frame);
    last = into.InsertAfterChild(last, child);
  }
  into.DeleteChild(&model);
}

// The rest of a world is useful without it; the rest of a robot is another robot.
void SdfExpander::leave_out(XMLElement& include, XMLElement& parent, const std::string& why) {
  const std::string uri = text_of(include.FirstChildElement("uri"));
  if (in_world_ && name_of_builtin(uri) == "ground_plane") {
    XMLElement* plane = make_ground_plane(document_);
    parent.InsertAfterChild(&include, plane);
    if (const std::string name = text_of(include.FirstChildElement("name")); !name.empty())
      plane->SetAttribute("name", name.c_str());
    set_child(*plane, "pose", include.FirstChildElement("pose"));
    xml_.repairs.push_back(remark(include, "'" + uri + "' is not there: an infinite plane stands for it"));
  } else if (in_world_) {
    xml_.losses.push_back(remark(include, name_of_builtin(uri) == "sun"
                                              ? "<include> is left out: '" + uri + "' is a light"
                                              : "<include> is left out: " + why));
    if (name_of_builtin(uri) != "sun") xml_.world->left_out.push_back(why);
  } else {
    fail_at(include, file_, "<include> " + why);
  }
  parent.DeleteChild(&include);
}

fs::path SdfExpander::find(const XMLElement&, const std::string& uri, const std::string& file) {
  return find_included(uri, file, packages_);
}

const SdfExpander::Source& SdfExpander::open(const fs::path& file, const XMLElement& asked_by) {
  Source& source = sources_[file.string()];
  if (source.document != nullptr) return source;
  source.file = file.string();
  const config::FileContent content = config::read_file(file, kMaxModelBytes);
  if (!content.fault.empty()) fail_at(asked_by, file_, "'" + file.string() + "': " + content.fault);
  source.document = std::make_unique<tinyxml2::XMLDocument>();
  parse_xml(*source.document, content.bytes, source.file);
  const XMLElement* root = source.document->RootElement();
  if (root == nullptr || std::strcmp(root->Name(), "sdf") != 0)
    throw config::ConfigError({source.file, root ? root->GetLineNum() : 0, ""},
                              "is no SDF file, and only SDF files can be included");
  source.version = version_of(*root);
  return source;
}

// Copies an element of another file, with its place.
XMLElement* SdfExpander::copy(const XMLElement& from, const std::string& file) {
  if (++copied_ > kMaxCopied)
    throw config::ConfigError(
        {file_, 0, ""}, "its included files have more than " + std::to_string(kMaxCopied) + " XML elements");
  places_.push_back({file, from.GetLineNum()});
  XMLElement* to = from.ShallowClone(&document_)->ToElement();
  to->SetUserData(&places_.back());
  for (const tinyxml2::XMLNode* child = from.FirstChild(); child; child = child->NextSibling())
    if (const XMLElement* element = child->ToElement())
      to->InsertEndChild(copy(*element, file));
    else if (child->ToText())
      to->InsertEndChild(child->ShallowClone(&document_));
  return to;
}

}  // namespace visum::scene
