// A device put where a program expects another one, for this process and what it becomes only: in a private
// mount namespace, another device's node is bound over /dev/NAME.
#pragma once

#include <string>
#include <vector>

namespace visum::exec {

struct Placement {
  std::string device;  // as the program opens it, "/dev/ttyS0"
  std::string source;  // what stands there from now on, "/dev/pts/3"
};

// Leaves this process' mount namespace for one of its own, as root or, where the kernel lets everybody, in a
// user namespace in which the user stays who he is. A device that does not exist gets a place: /dev becomes a
// copy of itself with one entry more. One thread only. Throws std::runtime_error that says what is not
// allowed.
void place_devices(const std::vector<Placement>& placements);

}  // namespace visum::exec
