// Finds the file that an <include> of an SDF file names; small readers of SDF's elements. Inner header, as
// xml_checks.h.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "server/scene/packages.h"
#include "server/scene/xml_checks.h"

namespace visum::scene {

// Finds the SDF file that a <uri> names: a file, or a folder whose model.config names its SDF file. Relative
// paths and file:// count from `file`; model:// and package:// are searched as meshes are. Empty if there is
// none. Addresses of a network are never followed.
std::filesystem::path find_included(const std::string& uri, const std::string& file,
                                    const Packages& packages);

// "sun" for model://sun: the last part of an address.
std::string name_of_builtin(const std::string& uri);

// The model that Gazebo ships as model://ground_plane. It belongs to the document, without a place in it.
XMLElement* make_ground_plane(tinyxml2::XMLDocument& document);

// The minor version: 7 for "1.7". 0 if the text is no version of SDF 1.
double sdf_version(const std::string& text);

bool has_include(const XMLElement& element);
bool is_true(const XMLElement* element);         // its text is "true" or "1"
std::string text_of(const XMLElement* element);  // without blanks around it; empty if it is null
// The numbers of its text; nothing if a word is no finite number.
std::optional<std::vector<double>> text_numbers(const XMLElement& element);

}  // namespace visum::scene
