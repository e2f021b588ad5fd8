// Turns Ctrl-C and SIGTERM into a flag that loops ask for. Verbs that must clean up before they end install
// it.
#pragma once

namespace visum::cli {

void catch_interrupts();
bool interrupted();

}  // namespace visum::cli
