// Who may ask what of the HTTP door: exact checks of Host and Origin, against pages of other origins and
// names that were made to point here (DNS rebinding). Pure; no socket, no Beast.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "protocol/web_pages.h"

namespace visum::protocol {

// The head of a request, as far as the rules look at it.
struct HttpHead {
  std::string method;
  std::string target;
  std::vector<std::string> hosts;    // all values of the field Host
  std::vector<std::string> origins;  // of Origin
  std::string local_address;         // "127.0.0.1", "::1": where the connection came to
  bool has_body = false;
  bool wants_upgrade = false;  // to anything
  bool is_websocket = false;   // a complete request for WebSocket
  std::vector<std::string> subprotocols;
};

struct HttpVerdict {
  int status = 200;    // 101: let it be a session; 200: ask the pages; else: refuse
  std::string reason;  // of a refusal
};

class HttpRules {
 public:
  // `hosts`: further names, "lab" at our own port or "lab:80" as a port that is mapped to ours. `https`: the
  // port speaks TLS.
  HttpRules(std::uint16_t port, std::vector<std::string> hosts, bool https = false);

  HttpVerdict judge(const HttpHead& head) const;

 private:
  std::string in_one_form(const std::string& host) const;
  bool is_origin_of(const std::string& origin, const std::string& host) const;
  bool knows_host(const std::string& host, const std::string& local_address) const;

  const std::string scheme_;          // "http://"
  const std::string port_suffix_;     // ":8080"
  const std::string default_suffix_;  // the one that browsers leave out
  std::vector<std::string> hosts_;    // in one form
};

// "/a/b" of "/a/b?c"; nothing where the target is no plain path ("//", "..", control characters, an URL).
std::string path_of(std::string_view target);

}  // namespace visum::protocol
