// How the mirror connects to an arm's server, and the credentials that it shows there.
#pragma once

#include <chrono>
#include <string>

#include "protocol/tls.h"

namespace visum::mirror {

inline constexpr std::chrono::milliseconds kConnectTimeout{1000};  // also for an answer
inline constexpr std::chrono::seconds kRetryPeriod{1};

struct Entry {
  std::string token;       // empty: the server asks for no token
  protocol::TlsFiles tls;  // none: plain text
};

}  // namespace visum::mirror
