// The HTTP door beside the TCP port, in plain words: what it may answer to a GET. Sessions over WebSocket
// come through the same door and are sessions like any other (server.h).
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace visum::protocol {

struct WebRequest {
  std::string path;           // "/assets/index.js", without the query
  bool takes_gzip = false;    // Accept-Encoding
  std::string if_none_match;  // an entity tag, or empty
  std::string bearer;         // the token of "Authorization: Bearer ...", or empty
  std::string identity;       // the name in the certificate that the client showed, or empty
};

struct WebReply {
  int status = 200;
  std::string content_type = "text/plain; charset=utf-8";
  std::string text;        // the body, or else
  std::string_view fixed;  // one that lives as long as the pages do
  bool gzip = false;       // of the body
  std::string etag;
  bool immutable = false;  // its name changes with its content: may be kept for a year
};

// Answers a GET; changes nothing. Called on the server's thread.
class WebPages {
 public:
  virtual ~WebPages() = default;
  virtual WebReply get(const WebRequest& request) = 0;
};

struct WebOptions {
  WebPages* pages = nullptr;  // none: no HTTP
  std::uint16_t port = 0;     // 0: any free one
  bool any_if_taken = false;  // where somebody else has that port, take any free one
  // Names besides localhost, 127.0.0.1, [::1] and the address that a connection came to, under which the page
  // may be asked for: "visum.lab", or with a port of its own "visum.lab:80".
  std::vector<std::string> hosts;
};

// How sessions over WebSocket are asked for (SPEC.md, section 1).
inline constexpr std::string_view kWebSocketPath = "/session";
inline constexpr std::string_view kWebSocketProtocol = "visum.v1";

}  // namespace visum::protocol
