// Converts between values and the texts of X3D fields.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "server/scene/convert/x3d_node.h"
#include "server/world/world_model.h"

namespace visum::scene {

// SFRotation: axis and angle.
std::string x3d_rotation(const Eigen::Quaterniond& q);
Eigen::Quaterniond quaternion_of_rotation(const double numbers[4]);

// MFString: texts in quotes.
std::string x3d_texts(const std::vector<std::string>& texts);
std::vector<std::string> texts_of(const std::string& value);

// X3D's cylinders lie along y, ours along z.
Eigen::Quaterniond from_y_to_z();

// The numbers of a field: exactly `count`, or any number of them if `count` is 0. `otherwise` if the field is
// missing. Throws ConfigError at the node.
std::vector<double> numbers_of(const X3dNode& node, const std::string& field, std::size_t count,
                               const std::vector<double>& otherwise, const std::string& file);
bool flag_of(const X3dNode& node, const std::string& field, bool otherwise, const std::string& file);

// The file in which a node stands, its name there, and type and name for messages: "Joint 'elbow'".
const std::string& file_of(const X3dNode& node, const std::string& file);
std::string name_in_file(const X3dNode& node);
std::string title_of(const X3dNode& node);

[[noreturn]] void fail_at(const X3dNode& node, const std::string& file, const std::string& message);

// The error text for a USE without its DEF. Names the nearest of `defs`.
std::string unknown_use(const std::string& use, const std::map<std::string, const X3dNode*>& defs);

// X3D has no models, so "arm/link_3" (a link of a model) becomes "arm.link_3".
std::string flat_name(std::string name);

}  // namespace visum::scene
