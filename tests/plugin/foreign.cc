// A plug-in whose std::string is another one.
#include "protocol/plugin/plugin.h"

VISUM_PLUGIN({.runtime = "libc++", .name = "foreign"})
