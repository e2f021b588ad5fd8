// Takes out of an SDF model what is not read, and repairs what no solid has. Inner header, as xml_checks.h.
#pragma once

#include "server/scene/xml_checks.h"

namespace visum::scene {

// Takes out everything that no reader needs, and says which of it a user would miss. Joints lose what their
// type does not use.
void take_out_unread(XMLElement& model, ModelXml& xml);

// Takes out visuals that cannot be shown and solids of no size, and repairs masses and inertias, as
// repair_urdf() does. Links that stand still lose their <inertial>.
void repair_sdf(XMLElement& model, const std::string& file, ModelXml& xml);

// Reads the <surface> of each collision of a link.
void read_surfaces(const XMLElement& link, const std::string& link_name, ModelXml& xml);

}  // namespace visum::scene
