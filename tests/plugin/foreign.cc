// A plug-in that was built with another C++ library.
#include "protocol/plugin/plugin.h"

VISUM_PLUGIN({.runtime = "libc++", .name = "foreign"})
