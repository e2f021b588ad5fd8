// The frames of an SDF model and the models nested in it, by the format's rules: every pose is relative to a
// frame that it names, or to a default one (http://sdformat.org/tutorials?tut=pose_frame_semantics). Inner
// header, as xml_checks.h. Any one thread; the document must outlive it.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>

#include "server/scene/xml_checks.h"
#include "server/world/world_model.h"

namespace visum::scene {

class SdfFrames {
 public:
  // Throws ConfigError for names that are missing or given twice. Only a joint may have the name of something
  // else, as in old files; the name then means the other. `file`: for places of errors.
  SdfFrames(const XMLElement& model, const std::string& file);
  ~SdfFrames();
  SdfFrames(const SdfFrames&) = delete;
  SdfFrames& operator=(const SdfFrames&) = delete;

  // All of these throw ConfigError at `asked_by` for a name that is no frame here, and for frames that are
  // relative to each other in a circle.

  // The pose of a frame in this model: of a link, a joint, a <frame>, a nested model, "inner::link", or
  // "__model__".
  world::Pose pose(const std::string& frame, const XMLElement& asked_by);
  world::Pose pose_of_joint(const XMLElement& joint);
  // The link, perhaps as "inner::link", that carries a frame.
  std::string link(const std::string& frame, const XMLElement& asked_by);
  // The pose in this model that <pose> of `element` gives, relative to the frame `otherwise` if it names
  // none.
  world::Pose pose_of(const XMLElement& element, const std::string& otherwise);
  // A nested model's own frames.
  SdfFrames& inner(const std::string& model) { return *inner_.at(model); }

 private:
  struct Frame {
    const XMLElement* element = nullptr;
    std::optional<world::Pose> pose;
    bool busy = false;  // pose() or link() are finding it
  };

  Frame& find(const std::string& name, const XMLElement& asked_by);
  // Splits "inner::rest". Returns the frames of that model; null where the name has no scope.
  SdfFrames* scope(const std::string& name, std::string& model, std::string& rest);
  world::Pose find_pose(const XMLElement& element);
  world::Pose pose(Frame& frame, const std::string& name, const XMLElement& asked_by);
  std::string canonical_link(const XMLElement& asked_by);
  [[noreturn]] void fail_circle(const std::string& name, const XMLElement& asked_by) const;

  const XMLElement& model_;
  const std::string file_;
  std::map<std::string, Frame> frames_, joints_;
  std::map<std::string, std::unique_ptr<SdfFrames>> inner_;
};

// Reads <pose> itself: "x y z roll pitch yaw", in degrees where its attribute says so, or "x y z qx qy qz
// qw" as rotation_format quat_xyzw. The identity where there is none. Throws ConfigError.
world::Pose raw_pose(const XMLElement& element, const std::string& file);

}  // namespace visum::scene
