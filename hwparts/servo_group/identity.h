// The blackboard `Identity`: a text that names the part's kind, its modules, and the source of their figures.
// Clients can only read it.
#pragma once

#include <string>

#include "hwparts/servo_group/drive_list.h"
#include "protocol/part_description.h"

namespace visum::servo_group {

// "kind: amtec_arm", then one line per module, then the source of the figures.
std::string identity_text(const std::string& kind, const DriveList& drives);
protocol::Blackboard identity_board(const std::string& text);

}  // namespace visum::servo_group
