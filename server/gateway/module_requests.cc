#include "server/gateway/module_requests.h"

#include "protocol/config/number_text.h"
#include "protocol/config/printable.h"
#include "protocol/part_description.h"

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

template <typename Order>
void ModuleRequests::relay(const Call& call, const Order& order, const char* kind, const std::string& what) {
  protocol::ModuleBoard::Refusal refusal;
  const auto target = board_.target_of(order, refusal);
  if (!target) return call.fail(refusal->first, refusal->second);
  clients_.at(*target).session->send(0, order);
  clients_.tell({kind,
                 order.part + "/" + (order.path.empty() ? "" : order.path + "/") + what,
                 {},
                 clients_.known_era(),
                 call.now.tick,
                 protocol::EventLevel::kWarning,
                 call.session.client_name()});
  call.reply(protocol::Ok{});
}

void ModuleRequests::handle(const Call& call, const protocol::OverrideModulePort& request) {
  relay(call, request, "override",
        request.port +
            (request.release ? " follows its edge again" : " holds " + config::number_text(request.value)));
}

void ModuleRequests::handle(const Call& call, const protocol::SetModuleParameter& request) {
  relay(call, request, "module_parameter",
        request.name + " = " + config::printable(protocol::value_text(request.value)));
}

}  // namespace visum::gateway
