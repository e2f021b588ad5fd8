#include "clients/visum/run/sweep.h"

#include <algorithm>
#include <cmath>

#include "clients/visum/common/format.h"
#include "protocol/config/flow.h"

namespace visum::run {
namespace {

using config::Node;

const std::string kTooMany = "gives more than " + std::to_string(Sweep::kMaxRuns) + " runs";

Node number_node(const std::string& digits, const Node& like) {
  return config::load_text(digits, like.place().file, like.folder());
}

}  // namespace

Sweep::Range Sweep::read_range(const Node& node) {
  node.allow_only({"from", "to", "step", "count"});
  const double from = node.get("from").number(), to = node.get("to").number();
  const auto step = node.find("step"), count = node.find("count");
  if (to < from) node.fail("'to' must not be less than 'from'");
  if (step && count) node.fail("needs 'step' or 'count', not both");
  if (count && from == to) count->fail("makes many of one value; a list may say it more than once");
  const double width = count ? (to - from) / static_cast<double>(count->integer(2, kMaxRuns) - 1)
                             : node.number_or("step", 1.0, config::kPositive);
  const double steps = (to - from) / width;
  if (!(steps < static_cast<double>(kMaxRuns))) node.fail(kTooMany);
  return {from, width, static_cast<std::size_t>(std::llround(std::floor(steps + 1e-9))) + 1};
}

Sweep::Axis Sweep::read_axis(const std::string& name, const Node& node) {
  if (const auto fault = config::variable_name_fault(name); !fault.empty())
    node.fail("'" + name + "' " + fault);
  if (node.kind() == Node::Kind::kMap) {
    if (auto distribution = Distribution::read(node)) return {name, node, std::move(*distribution)};
    return {name, node, read_range(node)};
  }
  if (node.kind() != Node::Kind::kList || node.size() == 0)
    node.fail("must be a list of values, or {from: 1, to: 10}");
  if (node.size() > kMaxListed)
    node.fail("lists more than " + std::to_string(kMaxListed) + " values; a range may have more");
  List values;
  for (std::size_t i = 0; i < node.size(); ++i) values.push_back(node.at(i));
  return {name, node, std::move(values)};
}

Sweep::Sweep(const Node& root) : sampling_(Sampling::read(root)) {
  const auto written = root.find("sweep");
  if (!written && sampling_) root.get("sampling").fail("needs a 'sweep' that names what is sampled");
  if (!written) return;
  config::ExpansionBudget budget;
  const Node sweep = config::expanded(*written, {}, budget);
  if (sweep.kind() != Node::Kind::kMap || sweep.keys().empty())
    sweep.fail("must be a map of names to values: {seed: {from: 1, to: 10}, payload: [1, 2]}");
  if (sweep.keys().size() > kMaxAxes) sweep.fail("more than " + std::to_string(kMaxAxes) + " names");
  double runs = 1.0;
  for (const std::string& name : sweep.keys()) {
    axes_.push_back(read_axis(name, sweep.get(name)));
    if (sampling_) continue;
    if (std::holds_alternative<Distribution>(axes_.back().values))
      axes_.back().node.fail("is a distribution, which needs 'sampling': {method: random, runs: 100}");
    runs *= static_cast<double>(count(axes_.back()));
    if (runs > static_cast<double>(kMaxRuns)) sweep.fail(kTooMany);
  }
}

std::size_t Sweep::count(const Axis& axis) {
  if (const auto* list = std::get_if<List>(&axis.values)) return list->size();
  return std::get<Range>(axis.values).count;
}

Node Sweep::value_at(const Axis& axis, std::size_t index) {
  if (const auto* list = std::get_if<List>(&axis.values)) return (*list)[index];
  // Rounded to 12 digits, so that 0.1 * 3 is 0.3: people read it, and equal values must make equal runs.
  const Range& range = std::get<Range>(axis.values);
  return number_node(cli::rounded(range.from + static_cast<double>(index) * range.width, 12), axis.node);
}

std::size_t Sweep::runs() const {
  if (sampling_) return sampling_->runs();
  std::size_t runs = 1;
  for (const Axis& axis : axes_) runs *= count(axis);
  return runs;
}

Node Sweep::value_in(const Axis& axis, double share) {
  if (const auto* distribution = std::get_if<Distribution>(&axis.values))
    return number_node(distribution->value(share), axis.node);
  const auto index = static_cast<std::size_t>(share * static_cast<double>(count(axis)));
  return value_at(axis, std::min(index, count(axis) - 1));
}

std::size_t Sweep::index_in(std::size_t axis, std::size_t run) const {
  std::size_t faster = 1;
  for (std::size_t i = axis + 1; i < axes_.size(); ++i) faster *= count(axes_[i]);
  return (run - 1) / faster % count(axes_[axis]);
}

SweepPoint Sweep::point_by(const std::function<Node(std::size_t axis)>& value) const {
  SweepPoint point;
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    Node node = value(i);
    point.described.emplace_back(axes_[i].name, config::flow(node));
    point.variables.emplace(axes_[i].name, std::move(node));
  }
  return point;
}

SweepPoint Sweep::point(std::size_t run) const {
  return point_by([&](std::size_t axis) {
    return sampling_ ? value_in(axes_[axis], sampling_->share(axis, run))
                     : value_at(axes_[axis], index_in(axis, run));
  });
}

std::vector<double> Sweep::shares(std::size_t run) const {
  std::vector<double> shares;
  for (std::size_t axis = 0; axis < axes_.size(); ++axis)
    shares.push_back(sampling_ ? sampling_->share(axis, run)
                               : (static_cast<double>(index_in(axis, run)) + 0.5) /
                                     static_cast<double>(count(axes_[axis])));
  return shares;
}

SweepPoint Sweep::point_at(const std::vector<double>& shares) const {
  return point_by([&](std::size_t axis) { return value_in(axes_[axis], shares[axis]); });
}

SweepPoint Sweep::point_of(const Node& values) const {
  if (values.kind() != Node::Kind::kMap) values.fail("must be a map of the sweep's names: {mass: 0.3}");
  for (const auto& name : values.keys())
    if (std::ranges::none_of(axes_, [&](const Axis& axis) { return axis.name == name; }))
      values.get(name).fail("the sweep has no such name");
  return point_by([&](std::size_t axis) { return values.get(axes_[axis].name); });
}

}  // namespace visum::run
