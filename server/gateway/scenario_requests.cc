#include "server/gateway/scenario_requests.h"

#include <unistd.h>

#include <chrono>
#include <system_error>
#include <utility>

#include "protocol/config/printable.h"
#include "protocol/config/unknown_name.h"
#include "server/gateway/plain_name.h"
#include "server/gateway/scenario_files.h"

namespace visum::gateway {
namespace {

using protocol::ErrorCode;
using protocol::Event;
using protocol::EventLevel;
using protocol::ScenarioVerdict;

constexpr std::chrono::nanoseconds kUsual = std::chrono::hours(1), kLongest = std::chrono::hours(24);
constexpr std::size_t kMostText = 300;  // bytes of a name or text that is kept

EventLevel level_of(ScenarioVerdict verdict) {
  if (verdict == ScenarioVerdict::kPassed) return EventLevel::kInfo;
  return verdict == ScenarioVerdict::kFailed ? EventLevel::kError : EventLevel::kWarning;
}

std::string hex(std::uint64_t number) {
  constexpr char kDigits[] = "0123456789abcdef";
  std::string text(16, '0');
  for (std::size_t i = 16; i-- > 0; number >>= 4) text[i] = kDigits[number & 15];
  return text;
}

}  // namespace

void ScenarioRequests::handle(const Call& call, const protocol::RunScenario& request) {
  if (!is_plain_name(request.name))
    return call.fail(ErrorCode::kBadValue, std::string("no path, but a name is needed: ") + kPlainNameRule);
  const std::chrono::nanoseconds timeout(request.timeout_ns);
  if (timeout.count() < 0 || timeout > kLongest)
    return call.fail(ErrorCode::kBadValue, "timeout_ns must be within 0 and one day");
  if (world_.models.empty()) return call.fail(ErrorCode::kWrongState, "this server has no scenarios");
  const auto file = scenario_file(world_.models, request.name);
  if (file.empty())
    return call.fail(ErrorCode::kUnknownName,
                     config::unknown_name("scenario", request.name, scenarios_in(world_.models)));
  if (run_) return call.fail(ErrorCode::kBusy, "the scenario '" + state_.name + "' runs; one runs at a time");
  const auto program = scenario_program();
  if (::access(program.c_str(), X_OK) != 0)
    return call.fail(
        ErrorCode::kWrongState,
        "a scenario needs the program 'visum' beside this server, and there is no " + program.string());
  try {
    run_ = std::make_unique<ScenarioRun>(program, file, timeout.count() == 0 ? kUsual : timeout);
  } catch (const std::system_error&) {
    return call.fail(ErrorCode::kBusy,
                     "no thread is left for it: the limit of processes or of memory is reached");
  }
  state_ = {request.name, true};
  lines_ = {kLinesPerSecond, protocol::TokenBucket::Time::clock::now()};
  clients_.tell_always({"scenario",
                        "the scenario '" + state_.name + "' begins",
                        {},
                        clients_.known_era(),
                        call.now.tick,
                        EventLevel::kInfo,
                        call.session.client_name()});
  call.reply(protocol::Ok{});
}

void ScenarioRequests::handle(const Call& call, const protocol::StopScenario&) {
  if (!run_) return call.fail(ErrorCode::kWrongState, "no scenario runs");
  run_->stop();
  call.reply(protocol::Ok{});
}

void ScenarioRequests::serve(const Published& now) {
  if (!run_) return;
  left_out_ += run_->take(news_);
  for (const auto& news : news_) tell(news, now.tick);
  news_.clear();
}

void ScenarioRequests::tell(const News& news, std::int64_t tick) {
  switch (news.kind) {
    case News::Kind::kLine:
      return tell_line(news.text, tick);
    case News::Kind::kCheck:
      return tell_check(news.check, tick);
    case News::Kind::kEnd:
      return tell_end(news, tick);
  }
}

void ScenarioRequests::tell_line(const std::string& text, std::int64_t tick) {
  if (!lines_.take(protocol::TokenBucket::Time::clock::now())) {
    ++left_out_;
    return;
  }
  tell_left_out(tick);
  clients_.tell(
      {"line", config::printable(text), {}, clients_.known_era(), tick, EventLevel::kInfo, state_.name});
}

void ScenarioRequests::tell_left_out(std::int64_t tick) {
  if (const auto lines = std::exchange(left_out_, 0); lines != 0)
    clients_.tell({"line",
                   std::to_string(lines) + " lines were left out",
                   {},
                   clients_.known_era(),
                   tick,
                   EventLevel::kWarning,
                   state_.name});
}

void ScenarioRequests::tell_check(const protocol::ScenarioCheck& check, std::int64_t tick) {
  if (state_.checks.size() < kMostChecks)
    state_.checks.push_back(
        {config::shortened(check.name, kMostText), check.passed, config::shortened(check.text, kMostText)});
  clients_.tell({"check",
                 config::printable(check.name + (check.passed ? ": passed, " : ": failed, ") + check.text),
                 {},
                 clients_.known_era(),
                 tick,
                 check.passed ? EventLevel::kInfo : EventLevel::kError,
                 state_.name});
}

void ScenarioRequests::tell_end(const News& end, std::int64_t tick) {
  run_.reset();
  tell_left_out(tick);
  state_.running = false;
  state_.verdict = end.verdict;
  state_.exit_code = end.exit_code;
  state_.text = config::shortened(config::printable(end.text), kMostText);
  state_.state_hash = end.state_hash;
  const std::string hash = end.state_hash == 0 ? "" : ", state hash " + hex(end.state_hash);
  clients_.tell_always({"scenario",
                        "the scenario '" + state_.name + "' " +
                            (end.verdict == ScenarioVerdict::kInvalid ? "is " : "has ") +
                            protocol::to_string(end.verdict) + ": " + state_.text + "; exit code " +
                            std::to_string(end.exit_code) + hash,
                        {},
                        clients_.known_era(),
                        tick,
                        level_of(end.verdict),
                        state_.name});
}

}  // namespace visum::gateway
