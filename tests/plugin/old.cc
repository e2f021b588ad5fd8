// A plug-in as of a plugin.h that is no more.
#include "protocol/plugin/plugin.h"

VISUM_PLUGIN({.abi = 0, .name = "old"})
