// The HTTP port's answers: the page's files, /healthz, /metrics, and the ports of a recording.
#pragma once

#include <functional>

#include "protocol/web_pages.h"
#include "server/gateway/gateway.h"
#include "server/gateway/page_files.h"

namespace visum::gateway {

class Playback;

// It only reads. Lives on the sessions' thread; the daemon owns it.
class Web : public protocol::WebPages {
 public:
  // `refused_connections` tells how many the server has turned away so far. `playback` is a recording that is
  // shown, whose ports the page plots; null: the world is a live one.
  Web(PageFiles files, Gateway& gateway, std::function<std::uint64_t()> refused_connections,
      Playback* playback = nullptr);

  protocol::WebReply get(const protocol::WebRequest& request) override;

 private:
  protocol::WebReply health() const;
  // False: the request shows neither a token nor a certificate that gives a role; `refusal` is filled.
  bool lets_in(const protocol::WebRequest& request, protocol::WebReply& refusal) const;
  protocol::WebReply metrics(const protocol::WebRequest& request) const;
  // Rows of a recording's ports.
  protocol::WebReply recorded(const protocol::WebRequest& request) const;

  PageFiles files_;
  Gateway& gateway_;
  std::function<std::uint64_t()> refused_connections_;
  Playback* const playback_;
};

}  // namespace visum::gateway
