// A session handler for the fuzz targets of sessions. It stands in for the gateway, without a world: it
// answers, sends samples, and closes on one request.
#pragma once

#include <cstdio>
#include <cstdlib>

#include "protocol/server.h"

namespace visum::testing {

[[noreturn]] inline void fail(const char* what) {
  std::fprintf(stderr, "%s\n", what);
  std::abort();
}

struct Answering final : protocol::SessionHandler {
  protocol::Role on_hello(protocol::Session&, const protocol::Hello& hello, protocol::Welcome&,
                          protocol::Error&) override {
    ++open;
    return hello.role;
  }
  void on_request(protocol::Session& session, std::uint64_t id, const protocol::Request& request) override {
    using namespace protocol;
    if (std::holds_alternative<Shutdown>(request)) return session.close(CloseReason::kShutdown);
    if (const auto* write = std::get_if<Write>(&request))
      session.send_latest(write->first_port % 4, PartSample{write->part, 1, 1, 1, write->values, {}, 0});
    session.send(id, Ok{});
  }
  void on_close(protocol::Session&, protocol::CloseReason) override { --open; }
  void on_notify() override {}
  int open = 0;  // hellos minus closes
};

}  // namespace visum::testing
