#include "clients/visum/run/actions.h"

#include <cmath>

#include "clients/visum/common/exit_code.h"
#include "clients/visum/common/parameters.h"
#include "clients/visum/run/lookup.h"

namespace visum::run {

void Actions::perform(const TimelineEntry& entry) try {
  std::visit([this](const auto& action) { perform(action); }, entry.action);
} catch (const protocol::RequestError& refusal) {
  const config::ConfigError placed(entry.place, refusal.what());
  throw cli::ExitError(cli::kFailed, placed.what());
}

void Actions::perform(const SetPort& set) {
  const auto found = find_port(catalogue_.parts.at(set.part), set.port, {});
  session_.request(protocol::AcquireLease{set.part, 0, set.take});
  session_.request(protocol::Write{set.part, static_cast<std::uint32_t>(found.index), {set.value}, 0});
  session_.request(protocol::ReleaseLease{set.part});
}

void Actions::perform(const Push& push) {
  session_.request(protocol::PushBody{push.body, push.force_n, push.torque_nm, push.point_m,
                                      std::llround(push.duration_s * 1e9)});
}

void Actions::perform(const SetParameter& set) {
  const auto& parameter = cli::find_parameter(set.part, catalogue_.parts.at(set.part).parameters, set.name);
  session_.request(protocol::SetParameter{set.part, set.name, cli::parse_value(parameter, set.value)});
}

void Actions::perform(const InjectFault& fault) {
  protocol::InjectFault request{fault.part, fault.kind, {}, std::llround(fault.duration_s * 1e9)};
  for (const auto& [name, value] : fault.numbers) request.numbers.push_back({name, value});
  session_.request(request);
}

}  // namespace visum::run
