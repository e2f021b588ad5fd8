// What the HTTP port answers: the page's files, /healthz, /metrics. Only reads; lives on the sessions'
// thread.
#pragma once

#include <functional>

#include "protocol/web_pages.h"
#include "server/gateway/gateway.h"
#include "server/gateway/page_files.h"

namespace visum::gateway {

class Playback;

class Web : public protocol::WebPages {
 public:
  // `refused_connections`: what the server has turned away so far.
  // `playback`: a recording that is shown, whose ports plots ask for; null: the world lives.
  Web(PageFiles files, Gateway& gateway, std::function<std::uint64_t()> refused_connections,
      Playback* playback = nullptr);

  protocol::WebReply get(const protocol::WebRequest& request) override;

 private:
  protocol::WebReply health() const;
  bool lets_in(const protocol::WebRequest& request, protocol::WebReply& refusal) const;
  protocol::WebReply metrics(const protocol::WebRequest& request) const;

  protocol::WebReply recorded(const protocol::WebRequest& request) const;

  PageFiles files_;
  Gateway& gateway_;
  std::function<std::uint64_t()> refused_connections_;
  Playback* const playback_;
};

}  // namespace visum::gateway
