#include "protocol/config/unknown_name.h"

#include <algorithm>

#include "protocol/config/printable.h"

namespace visum::config {
namespace {

constexpr std::size_t kMaxWord = 64;   // a longer word is not a misspelt name
constexpr std::size_t kMaxListed = 8;  // a longer list is of no help

// Edit distance in which exchanging two neighbouring letters counts as one step ("lenght").
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) last[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (a[i - 1] == b[j - 1] ? 0u : 1u)});
      const bool exchanged = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (exchanged) row[j] = std::min(row[j], before[j - 2] + 1);
    }
    std::swap(before, last);
    std::swap(last, row);
  }
  return last[b.size()];
}

}  // namespace

std::optional<std::string> nearest(std::string_view name, const std::vector<std::string>& known) {
  if (name.size() > kMaxWord) return std::nullopt;
  std::size_t best_distance = std::max<std::size_t>(1, name.size() / 3) + 1;
  std::optional<std::string> best;
  for (const std::string& candidate : known) {
    if (candidate.size() > kMaxWord) continue;
    const std::size_t distance = edit_distance(name, candidate);
    if (distance >= best_distance) continue;
    best_distance = distance;
    best = candidate;
  }
  return best;
}

std::string did_you_mean(std::string_view name, const std::vector<std::string>& known) {
  const auto near = nearest(name, known);
  return near ? "; did you mean '" + *near + "'?" : "";
}

std::string unknown_name(std::string_view what, std::string_view name,
                         const std::vector<std::string>& known) {
  std::string text = "there is no " + std::string(what) + " '" + printable(name) + "'";
  const std::string near = did_you_mean(name, known);
  if (!near.empty() || known.empty() || known.size() > kMaxListed) return text + near;
  if (known.size() == 1) return text + "; there is only '" + known[0] + "'";
  std::string list;
  for (const std::string& one : known) list += (list.empty() ? "" : ", ") + one;
  return text + "; there are: " + list;
}

}  // namespace visum::config
