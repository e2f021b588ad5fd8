#include "server/scene/robot_model.h"

#include "protocol/config/config.h"
#include "server/scene/sdf_robot.h"
#include "server/scene/urdf_robot.h"
#include "server/scene/xml_checks.h"

namespace visum::scene {

RobotModel read_robot_model(const std::filesystem::path& file, const std::string& text,
                            const Packages& packages) {
  if (is_mjcf(text)) return read_mjcf(file, text, packages);
  tinyxml2::XMLDocument document;
  parse_xml(document, text, file.string());
  const XMLElement* root = document.RootElement();
  const std::string tag = root ? root->Name() : "";
  if (tag == "robot") return read_urdf_robot(document, file, packages);
  if (tag == "sdf") return read_sdf_robot(document, file, packages);
  throw config::ConfigError(
      {file.string(), root ? root->GetLineNum() : 0, ""},
      "is neither URDF (<robot>) nor SDF (<sdf>) nor MJCF (<mujoco>): its root is <" + tag + ">");
}

}  // namespace visum::scene
