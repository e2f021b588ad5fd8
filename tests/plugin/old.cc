// A plug-in that was built with an older plugin.h.
#include "protocol/plugin/plugin.h"

VISUM_PLUGIN({.abi = 0, .name = "old"})
