#include "clients/visum/run/sweep.h"

#include <cmath>

#include "clients/visum/common/format.h"
#include "protocol/config/flow.h"

namespace visum::run {
namespace {

using config::Node;

const std::string kTooMany = "gives more than " + std::to_string(Sweep::kMaxRuns) + " runs";

// Rounds to 12 digits, so that 0.1 * 3 is 0.3: people read it, and equal values must make equal runs.
Node number_node(double number, const Node& like) {
  return config::load_text(cli::rounded(number, 12), like.place().file, like.folder());
}

std::vector<Node> read_range(const Node& node) {
  node.allow_only({"from", "to", "step", "count"});
  const double from = node.get("from").number(), to = node.get("to").number();
  const auto step = node.find("step"), count = node.find("count");
  if (to < from) node.fail("'to' must not be less than 'from'");
  if (step && count) node.fail("needs 'step' or 'count', not both");
  if (count && from == to) count->fail("makes many of one value; a list may say it more than once");
  const double width = count ? (to - from) / static_cast<double>(count->integer(2, Sweep::kMaxRuns) - 1)
                             : node.number_or("step", 1.0, config::kPositive);
  const double steps = (to - from) / width;
  if (!(steps < static_cast<double>(Sweep::kMaxRuns))) node.fail(kTooMany);
  std::vector<Node> values;
  for (std::int64_t i = 0, last = std::llround(std::floor(steps + 1e-9)); i <= last; ++i)
    values.push_back(number_node(from + static_cast<double>(i) * width, node));
  return values;
}

std::vector<Node> read_values(const Node& node) {
  if (node.kind() == Node::Kind::kMap) return read_range(node);
  if (node.kind() != Node::Kind::kList || node.size() == 0)
    node.fail("must be a list of values, or {from: 1, to: 10}");
  if (node.size() > Sweep::kMaxRuns) node.fail(kTooMany);
  std::vector<Node> values;
  for (std::size_t i = 0; i < node.size(); ++i) values.push_back(node.at(i));
  return values;
}

}  // namespace

Sweep::Sweep(const Node& root) {
  const auto written = root.find("sweep");
  if (!written) return;
  config::ExpansionBudget budget;
  const Node sweep = config::expanded(*written, {}, budget);
  if (sweep.kind() != Node::Kind::kMap || sweep.keys().empty())
    sweep.fail("must be a map of names to values: {seed: {from: 1, to: 10}, payload: [1, 2]}");
  if (sweep.keys().size() > kMaxAxes) sweep.fail("more than " + std::to_string(kMaxAxes) + " names");
  for (const std::string& name : sweep.keys()) {
    const Node values = sweep.get(name);
    if (const auto fault = config::variable_name_fault(name); !fault.empty())
      values.fail("'" + name + "' " + fault);
    axes_.push_back({name, read_values(values)});
    if (runs() > kMaxRuns) sweep.fail(kTooMany);
  }
}

std::size_t Sweep::runs() const {
  std::size_t runs = 1;
  for (const Axis& axis : axes_) runs *= axis.values.size();
  return runs;
}

Node Sweep::value(std::size_t axis, std::size_t run) const {
  std::size_t faster = 1;
  for (std::size_t i = axis + 1; i < axes_.size(); ++i) faster *= axes_[i].values.size();
  const auto& values = axes_[axis].values;
  return values[(run - 1) / faster % values.size()];
}

config::Variables Sweep::variables(std::size_t run) const {
  config::Variables variables;
  for (std::size_t i = 0; i < axes_.size(); ++i) variables.emplace(axes_[i].name, value(i, run));
  return variables;
}

std::vector<std::pair<std::string, std::string>> Sweep::described(std::size_t run) const {
  std::vector<std::pair<std::string, std::string>> described;
  for (std::size_t i = 0; i < axes_.size(); ++i)
    described.emplace_back(axes_[i].name, config::flow(value(i, run)));
  return described;
}

}  // namespace visum::run
