// Who may do what: the role that each request needs, and the tokens that give roles.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "protocol/messages.h"

namespace visum::gateway {

// The least role that may send this request. Hello needs none and is not asked about.
protocol::Role role_needed(const protocol::Request& request);

// What only a simulated world can do: hold time, go back in it, change bodies.
bool needs_world(const protocol::Request& request);

// The roles by token. Without a token file everybody on loopback gets the role that he asks for.
class Tokens {
 public:
  Tokens() = default;  // no file: no token is asked for
  // Lines of "observer|controller|admin TOKEN", # begins a comment; a token has at least 16 characters (128
  // bits as hex are 32). Throws ConfigError for a wrong line, or a file that others may read.
  explicit Tokens(const std::filesystem::path& file);

  bool required() const { return !entries_.empty(); }
  // The role granted to somebody who asks for `wanted`: at most that of his token; kUnspecified: not let in.
  protocol::Role grant(const std::string& token, protocol::Role wanted) const;

 private:
  struct Entry {
    protocol::Role role;
    std::string token;
  };
  std::vector<Entry> entries_;
};

// True for 127.0.0.0/8, ::1 and "localhost".
bool is_loopback(const std::string& address);

}  // namespace visum::gateway
