// Ctrl-C and SIGTERM as a flag that loops ask for. Installed by the verbs that have something to put in order
// first.
#pragma once

namespace visum::cli {

void catch_interrupts();
bool interrupted();

}  // namespace visum::cli
