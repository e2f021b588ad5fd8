#include <algorithm>

#include "clients/visum/run/quantity.h"
#include "clients/visum/run/scenario_parts.h"

namespace visum::run {
namespace {

using config::Node;

const std::vector<std::string> kBoundKeys{"below", "above", "between", "equals", "within"};

bool is_bound(const std::string& key) {
  return std::find(kBoundKeys.begin(), kBoundKeys.end(), key) != kBoundKeys.end();
}

Bounds read_bounds(const Node& node) {
  Bounds bounds;
  if (const auto below = node.find("below")) bounds.below = below->number();
  if (const auto above = node.find("above")) bounds.above = above->number();
  if (const auto equals = node.find("equals")) bounds.equals = equals->number();
  if (const auto between = node.find("between")) {
    const auto limits = between->numbers(2);
    if (limits[0] > limits[1]) between->fail("the first number must not be greater than the second");
    bounds.between = {limits[0], limits[1]};
  }
  if (const auto within = node.find("within")) {
    if (!bounds.equals) within->fail("belongs to 'equals'");
    bounds.within = within->number(config::kNonNegative);
  }
  if (!bounds.below && !bounds.above && !bounds.equals && !bounds.between) {
    node.fail("needs a bound: below, above, between or equals");
  }
  return bounds;
}

Window read_window(const Node& node) {
  Window window;
  if (node.kind() == Node::Kind::kScalar) {
    const std::string word = node.one_of({"end", "always", "eventually"});
    if (word == "always") window.kind = Window::Kind::kAlways;
    if (word == "eventually") window.kind = Window::Kind::kEventually;
    return window;
  }
  if (node.kind() != Node::Kind::kMap)
    node.fail("must be end, always, eventually, {from_s:, to_s:} or {by_s:}");
  node.allow_only({"from_s", "to_s", "by_s"});
  if (const auto by = node.find("by_s")) {
    if (node.keys().size() > 1) node.fail("'by_s' stands alone");
    window.kind = Window::Kind::kEventually;
    window.to_s = by->number(config::kNonNegative);
    return window;
  }
  window.kind = Window::Kind::kAlways;
  window.from_s = node.number_or("from_s", 0.0, config::kNonNegative);
  window.to_s = node.number_or("to_s", window.to_s, config::kNonNegative);
  if (window.from_s > window.to_s) node.fail("'from_s' must not be later than 'to_s'");
  return window;
}

}  // namespace

Condition read_condition(const Node& node) {
  if (node.kind() != Node::Kind::kMap) node.fail("must be a map, as {speed: {body: box}, below: 0.1}");
  std::optional<QuantitySpec> quantity;
  for (const std::string& key : node.keys()) {
    if (is_bound(key)) continue;
    const Node value = node.get(key);
    if (quantity) value.fail("a condition has one quantity; this is the second");
    quantity = read_quantity(key, value);
  }
  if (!quantity) node.fail("names no quantity");
  return {*quantity, read_bounds(node)};
}

CheckSpec read_check(const Node& node) {
  node.allow_only({"name", "that", "when"});
  CheckSpec check;
  check.that = read_condition(node.get("that"));
  check.name = node.text_or("name", "");
  if (const auto when = node.find("when")) check.when = read_window(*when);
  return check;
}

}  // namespace visum::run
