// The pages of the HTTP port as plain values, without HTTP's library: a request for a page and its answer.
// Sessions over WebSocket use the same port and are sessions like any other (server.h).
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace visum::protocol {

struct WebRequest {
  std::string path;           // "/assets/index.js", without the query
  bool takes_gzip = false;    // from Accept-Encoding
  std::string if_none_match;  // an entity tag, or empty
  std::string bearer;         // the token of "Authorization: Bearer ...", or empty
  std::string identity;       // the name in the client's certificate; empty if it showed none
};

struct WebReply {
  int status = 200;
  std::string content_type = "text/plain; charset=utf-8";
  std::string text;        // the body, if `fixed` is empty
  std::string_view fixed;  // a body that lives as long as the pages do
  bool gzip = false;       // the body is compressed
  std::string etag;
  bool immutable = false;  // the name changes with the content, so it may be cached for a year
};

// Answers GET requests and changes nothing. Called on the server's thread. Must outlive the server.
class WebPages {
 public:
  virtual ~WebPages() = default;
  virtual WebReply get(const WebRequest& request) = 0;
};

struct WebOptions {
  WebPages* pages = nullptr;  // null: no HTTP
  std::uint16_t port = 0;     // 0: any free port
  bool any_if_taken = false;  // if another program has that port, take any free one
  // Further names under which the page may be asked for: "visum.lab", or with an own port "visum.lab:80".
  // Always allowed are localhost, 127.0.0.1, [::1] and the address that the connection came to.
  std::vector<std::string> hosts;
};

// A client asks for a session over WebSocket with this path and this subprotocol (SPEC.md, section 1).
inline constexpr std::string_view kWebSocketPath = "/session";
inline constexpr std::string_view kWebSocketProtocol = "visum.v1";

}  // namespace visum::protocol
