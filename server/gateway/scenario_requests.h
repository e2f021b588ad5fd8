// Requests about scenarios of the installation, which run beside the world: one at a time, for
// administrators.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "protocol/token_bucket.h"
#include "server/gateway/call.h"
#include "server/gateway/scenario_run.h"

namespace visum::gateway {

// Tells what happens in the scenario as events. Lives on the sessions' thread, owned by the Gateway.
class ScenarioRequests {
 public:
  static constexpr std::size_t kMostChecks = 256;  // that are kept for ReadScenario
  static constexpr double kLinesPerSecond = 50.0;  // leaves room for other events

  ScenarioRequests(const StaticWorld& world, Clients& clients) : world_(world), clients_(clients) {}

  void handle(const Call& call, const protocol::RunScenario& request);
  void handle(const Call& call, const protocol::StopScenario&);
  void handle(const Call& call, const protocol::ReadScenario&) { call.reply(state_); }

  // Tells the news of the scenario that runs.
  void serve(const Published& now);

 private:
  using News = ScenarioRun::News;
  void tell(const News& news, std::int64_t tick);
  void tell_line(const std::string& text, std::int64_t tick);
  void tell_left_out(std::int64_t tick);
  void tell_check(const protocol::ScenarioCheck& check, std::int64_t tick);
  void tell_end(const News& end, std::int64_t tick);

  const StaticWorld& world_;
  Clients& clients_;
  std::unique_ptr<ScenarioRun> run_;  // null: none runs
  protocol::ScenarioState state_;     // of the one that runs, or ran last
  std::vector<News> news_;
  protocol::TokenBucket lines_{kLinesPerSecond, protocol::TokenBucket::Time{}};
  std::uint64_t left_out_ = 0;  // lines
};

}  // namespace visum::gateway
