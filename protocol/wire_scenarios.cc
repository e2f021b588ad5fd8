// Scenarios that the server runs beside its world: the requests about them, and the state of one.
#include "protocol/wire.h"
#include "visum.pb.h"

namespace visum::protocol::wire {

void PutScenarioRequest::operator()(const RunScenario& from) const {
  to.mutable_run_scenario()->set_name(from.name);
  to.mutable_run_scenario()->set_timeout_ns(from.timeout_ns);
}
void PutScenarioRequest::operator()(const StopScenario&) const {
  to.mutable_stop_scenario();
}
void PutScenarioRequest::operator()(const ReadScenario&) const {
  to.mutable_read_scenario();
}

bool take_scenario_request(const v1::ClientMessage& from, Request& to) {
  switch (from.request_case()) {
    case v1::ClientMessage::kRunScenario:
      to = RunScenario{from.run_scenario().name(), from.run_scenario().timeout_ns()};
      return true;
    case v1::ClientMessage::kStopScenario:
      to = StopScenario{};
      return true;
    case v1::ClientMessage::kReadScenario:
      to = ReadScenario{};
      return true;
    default:
      return false;
  }
}

void put(const ScenarioState& from, v1::ScenarioState& to) {
  to.set_name(from.name);
  to.set_running(from.running);
  to.set_verdict(static_cast<v1::ScenarioVerdict>(from.verdict));
  to.set_exit_code(from.exit_code);
  to.set_text(from.text);
  for (const ScenarioCheck& check : from.checks) {
    auto& w = *to.add_checks();
    w.set_name(check.name);
    w.set_passed(check.passed);
    w.set_text(check.text);
  }
  to.set_state_hash(from.state_hash);
}

bool take(const v1::ScenarioState& from, ScenarioState& to, std::string& why) {
  to.name = from.name();
  to.running = from.running();
  to.exit_code = from.exit_code();
  to.text = from.text();
  for (const auto& w : from.checks()) to.checks.push_back({w.name(), w.passed(), w.text()});
  to.state_hash = from.state_hash();
  return take_enum(from.verdict(), ScenarioVerdict::kInvalid, to.verdict, "verdict", why);
}

}  // namespace visum::protocol::wire
