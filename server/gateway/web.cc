#include "server/gateway/web.h"

#include <utility>

#include "server/gateway/metrics.h"
#include "server/gateway/playback.h"

namespace visum::gateway {

using protocol::WebReply;

Web::Web(PageFiles files, Gateway& gateway, std::function<std::uint64_t()> refused_connections,
         Playback* playback)
    : files_(std::move(files)),
      gateway_(gateway),
      refused_connections_(std::move(refused_connections)),
      playback_(playback) {}

WebReply Web::get(const protocol::WebRequest& request) {
  if (request.path == "/healthz") return health();
  if (request.path == "/metrics") return metrics(request);
  if (playback_ && request.path.starts_with("/recording/")) return recorded(request);
  if (files_.empty() && request.path == "/") {
    WebReply reply;
    reply.status = 503;
    reply.text =
        "visumd found no page beside itself; build the target 'page', or name its folder with --page\n";
    return reply;
  }
  return files_.get(request);
}

// Only for clients that may read ports.
WebReply Web::recorded(const protocol::WebRequest& request) const {
  WebReply reply;
  if (!lets_in(request, reply)) return reply;
  if (request.path == "/recording/events") {
    reply.content_type = "application/json";
    reply.text = playback_->events();
    return reply;
  }
  auto rows = playback_->ports_at(request.path);
  if (rows) {
    reply.content_type = "application/octet-stream";
    reply.text = std::move(*rows);
  } else {
    reply.status = 404;
    reply.text = "no such part or position of the recording\n";
  }
  return reply;
}

// Every program that reaches the port may ask this, so it tells no more than that.
WebReply Web::health() const {
  WebReply reply;
  const auto status = gateway_.metrics().status;
  reply.status = status.frozen || !status.stuck_node.empty() ? 503 : 200;
  reply.text = status.frozen ? "frozen\n" : "ok\n";
  if (!status.stuck_node.empty())
    reply.text = "stuck: a plug-in's node has not come back for " +
                 std::to_string(status.stuck_ns / 1'000'000'000) + " s\n";
  return reply;
}

bool Web::lets_in(const protocol::WebRequest& request, WebReply& refusal) const {
  if (gateway_.lets_in(request.bearer, request.identity, protocol::Role::kObserver)) return true;
  refusal.status = 401;
  refusal.text =
      "this needs the header Authorization: Bearer TOKEN, or a certificate whose name has a role\n";
  return false;
}

// Tells what Status tells, to clients that may ask for Status.
WebReply Web::metrics(const protocol::WebRequest& request) const {
  WebReply reply;
  if (!lets_in(request, reply)) return reply;
  auto metrics = gateway_.metrics();
  metrics.refused_connections = refused_connections_();
  reply.content_type = "text/plain; version=0.0.4; charset=utf-8";
  reply.text = to_prometheus(metrics);
  return reply;
}

}  // namespace visum::gateway
