#include "clients/visum/campaign/influence.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numeric>
#include <optional>

#include "protocol/config/config.h"

namespace visum::campaign {
namespace {

constexpr std::size_t kLeastInGroup = 4;

std::optional<double> real_in(const std::string& text) {
  double number = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(number)) return std::nullopt;
  return number;
}

// Groups of one value each; nothing where there are too many.
std::optional<std::size_t> group_by_value(const std::vector<std::string>& values,
                                          std::vector<std::size_t>& groups) {
  std::map<std::string, std::size_t> known;
  groups.clear();
  for (const auto& value : values) {
    groups.push_back(known.emplace(value, known.size()).first->second);
    if (known.size() > InfluenceOfParameters::kMostGroups) return std::nullopt;
  }
  return known.size();
}

// Groups of neighbours, of equal size; nothing where a value is no number.
std::optional<std::size_t> group_by_order(const std::vector<std::string>& values,
                                          std::vector<std::size_t>& groups) {
  std::vector<double> numbers;
  for (const auto& value : values) {
    const auto number = real_in(value);
    if (!number) return std::nullopt;
    numbers.push_back(*number);
  }
  const auto root = static_cast<std::size_t>(std::sqrt(static_cast<double>(numbers.size())) / 2.0);
  const std::size_t count = std::clamp<std::size_t>(root, 4, InfluenceOfParameters::kMostGroups);
  std::vector<std::size_t> order(numbers.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) { return numbers[a] < numbers[b]; });
  groups.assign(numbers.size(), 0);
  for (std::size_t i = 0; i < order.size(); ++i) groups[order[i]] = i * count / order.size();
  return count;
}

}  // namespace

double share_between(const std::vector<double>& values, const std::vector<std::size_t>& groups,
                     std::size_t count) {
  const std::size_t n = values.size();
  if (count < 2 || n < count * kLeastInGroup) return 0.0;
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(n);
  std::vector<double> sums(count, 0.0), sizes(count, 0.0);
  double all = 0.0, between = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    sums[groups[i]] += values[i] - mean;
    sizes[groups[i]] += 1.0;
    all += (values[i] - mean) * (values[i] - mean);
  }
  for (std::size_t group = 0; group < count; ++group)
    if (sizes[group] > 0.0) between += sums[group] * sums[group] / sizes[group];
  if (!(all > 0.0)) return 0.0;
  const double within = (all - between) / static_cast<double>(n - count);
  return std::clamp((between - static_cast<double>(count - 1) * within) / all, 0.0, 1.0);
}

InfluenceOfParameters::InfluenceOfParameters(Results& results, std::size_t last)
    : results_(results), last_(last) {
  std::map<std::string, std::size_t> places;
  std::size_t runs = 0;
  results.for_each(last, [&](const Row& row) {
    if (++runs > kMostRuns) return;
    const auto node = config::load_text(row.parameters, "the parameters of run " + std::to_string(row.run));
    for (const auto& name : node.keys()) {
      const auto [place, fresh] = places.emplace(name, parameters_.size());
      if (fresh) parameters_.push_back({name, {}});
      parameters_[place->second].values.emplace(row.run, node.get(name).text());
    }
  });
}

std::vector<Influence> InfluenceOfParameters::on(const std::string& check) const {
  std::vector<std::size_t> runs;
  std::vector<double> margins;
  Statement found(
      results_.database(),
      "SELECT run, margin FROM checks WHERE name = ? AND run > 0 AND run <= ? AND margin IS NOT NULL "
      "ORDER BY run LIMIT " +
          std::to_string(kMostRuns));
  found.bind(check).bind(last_);
  while (found.step())
    if (const double margin = *found.real(1); std::isfinite(margin)) {
      runs.push_back(found.size(0));
      margins.push_back(margin);
    }
  std::vector<Influence> influences;
  for (const Parameter& parameter : parameters_) {
    std::vector<std::string> values;
    std::vector<double> of;
    for (std::size_t i = 0; i < runs.size(); ++i) {
      const auto value = parameter.values.find(runs[i]);
      if (value == parameter.values.end()) continue;
      values.push_back(value->second);
      of.push_back(margins[i]);
    }
    std::vector<std::size_t> groups;
    auto count = group_by_value(values, groups);
    if (!count) count = group_by_order(values, groups);
    if (count && *count > 1 && values.size() >= *count * kLeastInGroup)
      influences.push_back({parameter.name, share_between(of, groups, *count)});
  }
  std::ranges::stable_sort(influences, [](const auto& a, const auto& b) { return a.share > b.share; });
  return influences;
}

}  // namespace visum::campaign
