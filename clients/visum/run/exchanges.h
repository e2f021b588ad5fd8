// Finds controllers of a scenario that exchanged nothing with a part: a run proves nothing about those. Pure
// functions.
#pragma once

#include <string>
#include <vector>

#include "clients/visum/run/scenario.h"
#include "protocol/messages.h"

namespace visum::run {

// Returns why the run is invalid: it is not known of a controller that it has exchanged something, by the
// server's status at the end. Empty: it is known of all.
//
// A controller's own are the sessions under its client's name, those that its gate names, and the buses that
// its command names. What came under a name that no controller has, or over a bus that none names, is the
// controller's if there is only one; among several it may be anyone's, and shows nothing. The same holds of a
// name or a bus that several controllers share which are all to exchange something.
std::string find_silent_controller(const std::vector<ControllerSpec>& controllers,
                                   const protocol::ServerStatus& status);

}  // namespace visum::run
