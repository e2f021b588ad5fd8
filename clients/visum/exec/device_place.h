// Puts a device where a program expects another one, for this process and the program that it becomes only:
// in a private mount namespace, another device's node is bound over /dev/NAME.
#pragma once

#include <string>
#include <vector>

namespace visum::exec {

struct Placement {
  std::string device;  // as the program opens it, "/dev/ttyS0"
  std::string source;  // the device that it gets instead, "/dev/pts/3"
};

// Moves this process into a mount namespace of its own: as root or, where the kernel lets every user, in a
// user namespace that keeps the user's id. Where the device does not exist, /dev becomes a copy of itself
// with one more entry. The process may have one thread only. Throws std::runtime_error that says what is not
// allowed.
void place_devices(const std::vector<Placement>& placements);

}  // namespace visum::exec
