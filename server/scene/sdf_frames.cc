#include "server/scene/sdf_frames.h"

#include <cstring>
#include <numbers>
#include <vector>

#include "protocol/config/unknown_name.h"
#include "server/scene/sdf_include.h"
#include "server/scene/values.h"

namespace visum::scene {
namespace {

constexpr const char* kModelFrame = "__model__";

bool is(const XMLElement& element, const char* tag) {
  return std::strcmp(element.Name(), tag) == 0;
}

std::string attribute(const XMLElement& element, const char* name) {
  const char* value = element.Attribute(name);
  return value ? value : "";
}

bool is_frame_element(const XMLElement& element) {
  return is(element, "link") || is(element, "joint") || is(element, "frame") || is(element, "model");
}

std::string relative_to(const XMLElement& element) {
  const XMLElement* pose = element.FirstChildElement("pose");
  return pose ? attribute(*pose, "relative_to") : "";
}

// Marks a frame as being looked for, so that a circle is found.
class Busy {
 public:
  explicit Busy(bool& flag) : flag_(flag) { flag_ = true; }
  ~Busy() { flag_ = false; }
  Busy(const Busy&) = delete;
  Busy& operator=(const Busy&) = delete;

 private:
  bool& flag_;
};

}  // namespace

world::Pose raw_pose(const XMLElement& element, const std::string& file) {
  const XMLElement* pose = element.FirstChildElement("pose");
  const auto numbers = pose ? text_numbers(*pose) : std::vector<double>{};
  if (!numbers) fail_at(*pose, file, "<pose> must hold numbers, is '" + text_of(pose) + "'");
  const auto& n = *numbers;
  if (n.empty()) return {};
  const std::string format = attribute(*pose, "rotation_format");
  const std::size_t wanted = format == "quat_xyzw" ? 7 : 6;
  if (!format.empty() && format != "quat_xyzw" && format != "euler_rpy")
    fail_at(*pose, file, "rotation_format must be euler_rpy or quat_xyzw, is '" + format + "'");
  if (n.size() != wanted)
    fail_at(*pose, file,
            "<pose> must hold " + std::to_string(wanted) + " numbers, holds " + std::to_string(n.size()));
  const Eigen::Vector3d place(n[0], n[1], n[2]);
  if (wanted == 7) {
    const Eigen::Quaterniond turn(n[6], n[3], n[4], n[5]);
    if (turn.norm() < 1e-9) fail_at(*pose, file, "the quaternion of <pose> is zero");
    return {place, turn.normalized()};
  }
  const std::string degrees = attribute(*pose, "degrees");
  const double unit = degrees == "true" || degrees == "1" ? std::numbers::pi / 180.0 : 1.0;
  return {place, quaternion_from_rpy(unit * Eigen::Vector3d(n[3], n[4], n[5])).normalized()};
}

SdfFrames::SdfFrames(const XMLElement& model, const std::string& file) : model_(model), file_(file) {
  for (auto child = model.FirstChildElement(); child; child = child->NextSiblingElement()) {
    if (!is_frame_element(*child)) continue;
    const std::string name = attribute(*child, "name");
    if (name.empty()) fail_at(*child, file_, std::string("a <") + child->Name() + "> needs a name");
    auto& taken = is(*child, "joint") ? joints_ : frames_;
    if (!taken.emplace(name, Frame{child}).second)
      fail_at(*child, file_, "the name '" + name + "' is given twice in one model");
    if (is(*child, "model")) inner_.emplace(name, std::make_unique<SdfFrames>(*child, file));
  }
}

SdfFrames::~SdfFrames() = default;

void SdfFrames::fail_circle(const std::string& name, const XMLElement& asked_by) const {
  fail_at(asked_by, file_, "the frame '" + name + "' is relative to itself, over others");
}

SdfFrames* SdfFrames::scope(const std::string& name, std::string& model, std::string& rest) {
  const auto colons = name.find("::");
  if (colons == std::string::npos) return nullptr;
  model = name.substr(0, colons);
  rest = name.substr(colons + 2);
  const auto found = inner_.find(model);
  return found == inner_.end() ? nullptr : found->second.get();
}

SdfFrames::Frame& SdfFrames::find(const std::string& name, const XMLElement& asked_by) {
  std::vector<std::string> known;
  for (auto* frames : {&frames_, &joints_}) {
    const auto found = frames->find(name);
    if (found != frames->end()) return found->second;
    for (const auto& [other, frame] : *frames) known.push_back(other);
  }
  fail_at(asked_by, file_, config::unknown_name("frame", name, known));
}

world::Pose SdfFrames::pose(const std::string& name, const XMLElement& asked_by) {
  if (name == kModelFrame) return {};
  std::string model, rest;
  if (SdfFrames* inside = scope(name, model, rest))
    return pose(model, asked_by) * inside->pose(rest, asked_by);
  return pose(find(name, asked_by), name, asked_by);
}

world::Pose SdfFrames::pose_of_joint(const XMLElement& joint) {
  const std::string name = attribute(joint, "name");
  return pose(joints_.at(name), name, joint);
}

world::Pose SdfFrames::pose(Frame& frame, const std::string& name, const XMLElement& asked_by) {
  if (frame.pose) return *frame.pose;
  if (frame.busy) fail_circle(name, asked_by);
  const Busy busy(frame.busy);
  frame.pose = find_pose(*frame.element);
  return *frame.pose;
}

world::Pose SdfFrames::find_pose(const XMLElement& element) {
  std::string otherwise = kModelFrame;
  if (is(element, "joint")) {
    otherwise = text_of(element.FirstChildElement("child"));
    if (otherwise.empty()) fail_at(element, file_, "a <joint> needs a <child>");
  }
  if (is(element, "frame"))
    if (const std::string carrier = attribute(element, "attached_to"); !carrier.empty()) otherwise = carrier;
  const world::Pose found = pose_of(element, otherwise);
  if (!is(element, "model")) return found;
  // The pose is that of the placement frame in it.
  const std::string placed = attribute(element, "placement_frame");
  if (placed.empty()) return found;
  return found * inner_.at(attribute(element, "name"))->pose(placed, element).inverse();
}

world::Pose SdfFrames::pose_of(const XMLElement& element, const std::string& otherwise) {
  const std::string base = relative_to(element);
  return pose(base.empty() ? otherwise : base, element) * raw_pose(element, file_);
}

std::string SdfFrames::canonical_link(const XMLElement& asked_by) {
  const std::string named = attribute(model_, "canonical_link");
  if (!named.empty()) return link(named, model_);
  if (const auto first = model_.FirstChildElement("link")) return attribute(*first, "name");
  if (const auto first = model_.FirstChildElement("model")) {
    const std::string name = attribute(*first, "name");
    return name + "::" + inner(name).canonical_link(asked_by);
  }
  fail_at(asked_by, file_, "the model '" + attribute(model_, "name") + "' has no link");
}

std::string SdfFrames::link(const std::string& name, const XMLElement& asked_by) {
  if (name == kModelFrame) return canonical_link(asked_by);
  std::string model, rest;
  if (SdfFrames* inside = scope(name, model, rest)) return model + "::" + inside->link(rest, asked_by);
  Frame& frame = find(name, asked_by);
  if (is(*frame.element, "link")) return name;
  if (is(*frame.element, "model")) return name + "::" + inner(name).canonical_link(asked_by);
  if (frame.busy) fail_circle(name, asked_by);
  const Busy busy(frame.busy);
  if (is(*frame.element, "joint"))
    return link(text_of(frame.element->FirstChildElement("child")), *frame.element);
  const std::string carrier = attribute(*frame.element, "attached_to");
  return link(carrier.empty() ? kModelFrame : carrier, *frame.element);
}

}  // namespace visum::scene
