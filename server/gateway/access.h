// Access rules: the role that each request needs, and the tokens and certificates that give roles.
#pragma once

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "protocol/config/config.h"
#include "protocol/messages.h"

namespace visum::gateway {

// The least role that may send this request. Hello needs no role and is not asked about. Every client may
// pull an emergency stop; only a controller may release it.
protocol::Role role_needed(const protocol::Request& request);

// True for the request that stops a part: it sets the parameter `Emergency Stop` to true.
bool is_emergency_stop(const protocol::Request& request);

// True for requests that only a simulated world can carry out: to hold time, go back in it, change bodies.
bool needs_world(const protocol::Request& request);
// True for requests that change nothing in a recording that is shown: reads, and moves within it. `steering`
// is the part that moves it.
bool leaves_recording(const protocol::Request& request, const std::string& steering);

// The roles by token, and by the name in a client's certificate. Without a token file, every client on
// loopback and every client with a certificate gets the role that it asks for. Constant after construction.
class Tokens {
 public:
  Tokens() = default;  // no file: no token is asked for
  // Lines of "observer|controller|admin TOKEN" or "... CN=NAME", # begins a comment; a token has at least 16
  // characters (128 bits as hex are 32). Throws ConfigError for a wrong line, or a file that is not ours
  // alone (config::read_secret_file).
  explicit Tokens(const std::filesystem::path& file);

  bool required() const { return !entries_.empty(); }
  // The role granted to a client that asks for `wanted`: at most the role of its token or of the name in its
  // certificate ("": it showed none). kUnspecified: it is not let in.
  protocol::Role grant(const std::string& token, const std::string& identity, protocol::Role wanted) const;
  // True if `matches` is true for one of the tokens.
  template <typename Matches>
  bool any_token(const Matches& matches) const {
    return std::ranges::any_of(
        entries_, [&](const Entry& entry) { return !entry.token.empty() && matches(entry.token); });
  }

 private:
  struct Entry {
    protocol::Role role;
    std::string token;  // empty: `identity` gives the role
    std::string identity;
  };
  static Entry read_entry(protocol::Role role, const std::string& words, const config::Place& place);

  std::vector<Entry> entries_;
};

// True for 127.0.0.0/8, ::1 and "localhost".
bool is_loopback(const std::string& address);

}  // namespace visum::gateway
