// The rules of the HTTP door. They check Host and Origin exactly, against pages of other origins and against
// names that were made to point here (DNS rebinding). Pure functions of the head; no socket, no Beast.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "protocol/web_pages.h"

namespace visum::protocol {

// The fields of a request's head that the rules look at.
struct HttpHead {
  std::string method;
  std::string target;
  std::vector<std::string> hosts;    // all values of the field Host
  std::vector<std::string> origins;  // of Origin
  std::string local_address;         // "127.0.0.1", "::1": our end of the connection
  bool has_body = false;
  bool wants_upgrade = false;  // to anything
  bool is_websocket = false;   // a complete request for WebSocket
  std::vector<std::string> subprotocols;
};

struct HttpVerdict {
  int status = 200;    // 101: make it a session; 200: ask the pages; else: refuse
  std::string reason;  // why it is refused
};

class HttpRules {
 public:
  // `hosts` are further names: "lab" at our own port, or "lab:80" if port 80 is mapped to ours. `https`: the
  // port speaks TLS.
  HttpRules(std::uint16_t port, std::vector<std::string> hosts, bool https = false);

  HttpVerdict judge(const HttpHead& head) const;

 private:
  // Lower case, and without the scheme's own port, so that equal hosts compare equal.
  std::string in_one_form(const std::string& host) const;
  bool is_origin_of(const std::string& origin, const std::string& host) const;
  bool knows_host(const std::string& host, const std::string& local_address) const;

  const std::string scheme_;          // "http://"
  const std::string port_suffix_;     // ":8080"
  const std::string default_suffix_;  // of the scheme; browsers leave it out
  std::vector<std::string> hosts_;    // in one form
};

// The path of a target: "/a/b" of "/a/b?c". Empty if it is not a plain path ("//", "..", control characters,
// a URL).
std::string path_of(std::string_view target);

}  // namespace visum::protocol
