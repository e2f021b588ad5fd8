// Who may do what: the role that each request needs, and the tokens and certificates that give roles.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "protocol/config/config.h"
#include "protocol/messages.h"

namespace visum::gateway {

// The least role that may send this request. Hello needs none and is not asked about. Anybody may pull an
// emergency stop; to release it takes a controller.
protocol::Role role_needed(const protocol::Request& request);

// What only a simulated world can do: hold time, go back in it, change bodies.
bool needs_world(const protocol::Request& request);
// Whether it changes nothing in a recording that is shown: reads, and moves within it. `steering`: the part
// that does.
bool leaves_recording(const protocol::Request& request, const std::string& steering);

// The roles by token, and by the name in a client's certificate. Without a token file everybody on loopback,
// and everybody with a certificate, gets the role that he asks for.
class Tokens {
 public:
  Tokens() = default;  // no file: no token is asked for
  // Lines of "observer|controller|admin TOKEN" or "... CN=NAME", # begins a comment; a token has at least 16
  // characters (128 bits as hex are 32). Throws ConfigError for a wrong line, or a file that others may read.
  explicit Tokens(const std::filesystem::path& file);

  bool required() const { return !entries_.empty(); }
  // The role granted to somebody who asks for `wanted`: at most that of his token or of the name in his
  // certificate ("": he showed none); kUnspecified: not let in.
  protocol::Role grant(const std::string& token, const std::string& identity, protocol::Role wanted) const;

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
