// Translates parts that drive joints between scenes and X3D. A MotorJoint of X3D says that a motor acts
// between two bodies about an axis. Our motor belongs to a hardware part with ports. So the part is stored as
// YAML in the metadata of the collection, and each hinge that it drives has a MotorJoint beside its joint. A
// part is read only if all of its MotorJoints are there.
// read.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "server/scene/convert/output.h"
#include "server/scene/draft.h"

namespace visum::scene {

// The parts that X3D's metadata can hold: those of built-in kinds that drive hinges and sliders by a drives
// file. Notes the other parts as losses.
std::vector<const PartPlan*> parts_with_motors(const Scene& scene, Output& output);

// The list `parts:`, with the joints' names of a scene without models. Drives go into companion files.
std::string motors_yaml(const Scene& scene, const std::vector<const PartPlan*>& parts, Output& output);

// `motors`: the joints that have a MotorJoint. Call it after the joints are read and before sort_world().
void read_motors(Draft& draft, const config::Node& parts, const std::set<std::string>& motors);

}  // namespace visum::scene
