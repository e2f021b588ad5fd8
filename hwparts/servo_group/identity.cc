#include "hwparts/servo_group/identity.h"

namespace visum::servo_group {

std::string identity_text(const std::string& kind, const DriveList& drives) {
  std::string text = "kind: " + kind + "\n";
  for (const auto& drive : drives.drives) {
    text += "module " + std::to_string(drive.data.module) + ": " + drive.data.type + "\n";
  }
  return text + "data: " + drives.source + "\n";
}

protocol::Blackboard identity_board(const std::string& text) {
  return {"Identity", "text/plain", 1, text.size(), text.size(), false};
}

}  // namespace visum::servo_group
