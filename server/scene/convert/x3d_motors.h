// What drives joints, between scenes and X3D. X3D's MotorJoint says that a motor acts between two bodies
// about an axis; ours is a hardware part with ports, so the part stands in the metadata of the collection, as
// YAML, and each hinge that it drives has a MotorJoint beside its joint. Without all of those the part is not
// read.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "server/scene/convert/output.h"
#include "server/scene/draft.h"

namespace visum::scene {

// The parts that X3D's metadata can hold: those of Visum's own kinds that drive hinges and sliders by a
// drives file. Of the others it tells that they are lost.
std::vector<const PartPlan*> parts_with_motors(const Scene& scene, Output& output);

// `parts:` with the names that joints have where there are no models; their drives go into files of their
// own.
std::string motors_yaml(const Scene& scene, const std::vector<const PartPlan*>& parts, Output& output);

// `motors`: the joints that have a MotorJoint. After the joints, before sort_world.
void read_motors(Draft& draft, const config::Node& parts, const std::set<std::string>& motors);

}  // namespace visum::scene
