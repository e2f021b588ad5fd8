#include "clients/visum/run/decide.h"

namespace visum::run {

std::optional<Decide> read_decide(const config::Node& root) {
  const auto node = root.find("decide");
  if (!node) return std::nullopt;
  if (node->kind() != config::Node::Kind::kMap)
    node->fail("must be a map: {at_least: 0.99, reject_below: 0.97}");
  node->allow_only({"at_least", "reject_below", "false_reject", "false_accept"});
  constexpr config::Range kShare{1e-9, 1.0 - 1e-9, false}, kRisk{1e-12, 0.5, false};
  Decide decide;
  decide.at_least = node->get("at_least").number(kShare);
  decide.reject_below = node->get("reject_below").number(kShare);
  decide.false_reject = node->number_or("false_reject", decide.false_reject, kRisk);
  decide.false_accept = node->number_or("false_accept", decide.false_accept, kRisk);
  if (decide.reject_below >= decide.at_least)
    node->get("reject_below").fail("must be less than 'at_least': between the two either verdict is right");
  return decide;
}

}  // namespace visum::run
