// What opens the door of an arm's server.
#pragma once

#include <string>

#include "protocol/tls.h"

namespace visum::gateway {

struct Entry {
  std::string token;       // empty: none is wanted
  protocol::TlsFiles tls;  // none: plain text
};

}  // namespace visum::gateway
