#include "server/gateway/module_requests.h"

#include "protocol/config/number_text.h"

namespace visum::gateway {
namespace {

void answer(const Call& call, const protocol::ModuleBoard::Refusal& refusal) {
  if (refusal) return call.fail(refusal->first, refusal->second);
  call.reply(protocol::Ok{});
}

}  // namespace

void ModuleRequests::handle(const Call& call, const protocol::AnnounceModules& request) {
  const auto refusal = board_.announce(call.session.id(), call.session.client_name(), request);
  answer(call, refusal);
  if (refusal) return;
  const std::string what = request.modules.empty()
                               ? "' is no longer announced"
                               : "' has " + std::to_string(request.modules.size()) + " modules and groups";
  clients_.tell({"modules",
                 "part '" + request.part + what,
                 {},
                 clients_.known_era(),
                 call.now.tick,
                 protocol::EventLevel::kInfo,
                 call.session.client_name()});
}

void ModuleRequests::handle(const Call& call, const protocol::ReportModules& request) {
  answer(call, board_.report(call.session.id(), request));
}

void ModuleRequests::handle(const Call& call, const protocol::ListModules& request) {
  if (const auto refusal = board_.check(request)) return call.fail(refusal->first, refusal->second);
  call.reply(board_.list(request));
}

void ModuleRequests::handle(const Call& call, const protocol::OverrideModulePort& request) {
  protocol::ModuleBoard::Refusal refusal;
  const auto target = board_.target_of(request, refusal);
  if (!target) return call.fail(refusal->first, refusal->second);
  clients_.at(*target).session->send(0, request);
  const std::string value =
      request.release ? " follows its edge again" : " holds " + config::number_text(request.value);
  clients_.tell({"override",
                 request.part + "/" + request.path + "/" + request.port + value,
                 {},
                 clients_.known_era(),
                 call.now.tick,
                 protocol::EventLevel::kWarning,
                 call.session.client_name()});
  call.reply(protocol::Ok{});
}

}  // namespace visum::gateway
