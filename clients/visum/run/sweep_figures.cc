#include "clients/visum/run/sweep_figures.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <set>

#include "clients/visum/common/format.h"
#include "clients/visum/common/markup.h"

namespace visum::run {
namespace {

using Outcome = SweptRun::Outcome;

constexpr std::size_t kMostGroups = 12;  // of a parameter: its values, or stretches of equal length
constexpr double kRunsPerCell = 3.0;     // so many stretches that a cell of the map has about so many runs
constexpr std::size_t kMostDots = 500;   // more runs are shown as a band and its mean
constexpr double kWidth = 760.0, kHeight = 200.0;
constexpr double kLeft = 112.0, kRight = 14.0, kTop = 10.0, kBottom = 34.0;
constexpr double kCellHeight = 26.0;

std::optional<double> number_of(const std::string& text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool whole = error == std::errc() && end == text.data() + text.size() && std::isfinite(value);
  return whole ? std::optional(value) : std::nullopt;
}

const std::string* value_of(const SweptRun& run, const std::string& name) {
  const auto found = std::ranges::find(run.values, name, &std::pair<std::string, std::string>::first);
  return found == run.values.end() ? nullptr : &found->second;
}

// A parameter of the sweep, its values in groups.
class Axis {
 public:
  Axis(std::span<const SweptRun> runs, std::string name) : name_(std::move(name)) {
    std::set<std::string> texts;
    for (const auto& run : runs)
      if (const auto* value = value_of(run, name_)) texts.insert(*value);
    for (const auto& text : texts) values_.push_back({number_of(text), text});
    numeric_ = std::ranges::all_of(values_, [](const auto& value) { return value.first.has_value(); });
    if (numeric_) std::ranges::sort(values_);
    if (values_.size() <= kMostGroups || !numeric_) return;
    low_ = *values_.front().first;
    const auto wanted = std::sqrt(static_cast<double>(runs.size()) / kRunsPerCell);
    stretches_ = std::clamp(static_cast<std::size_t>(wanted), std::size_t{3}, kMostGroups);
    width_ = (*values_.back().first - low_) / static_cast<double>(stretches_);
  }

  const std::string& name() const { return name_; }
  bool usable() const { return values_.size() >= 2 && (numeric_ || values_.size() <= kMostGroups); }
  std::size_t groups() const { return width_ > 0.0 ? stretches_ : values_.size(); }
  std::string label(std::size_t group) const {
    if (width_ == 0.0) return values_[group].second;
    return cli::rounded(low_ + static_cast<double>(group) * width_, 3) + " to " +
           cli::rounded(low_ + static_cast<double>(group + 1) * width_, 3);
  }
  std::optional<std::size_t> group(const SweptRun& run) const {
    const auto* text = value_of(run, name_);
    if (!text) return std::nullopt;
    if (width_ > 0.0)
      return std::min(stretches_ - 1, static_cast<std::size_t>((*number_of(*text) - low_) / width_));
    const auto found = std::ranges::find(values_, *text, &Value::second);
    return static_cast<std::size_t>(found - values_.begin());
  }
  // Where a run is along the axis: the number itself, or the group's number.
  std::optional<double> place(const SweptRun& run) const {
    const auto* text = value_of(run, name_);
    if (!text) return std::nullopt;
    return numeric_ ? number_of(*text) : std::optional(static_cast<double>(*group(run)));
  }
  std::string low() const { return end(values_.front()); }
  std::string high() const { return end(values_.back()); }

 private:
  using Value = std::pair<std::optional<double>, std::string>;
  std::string end(const Value& value) const {
    return numeric_ ? cli::readable(*value.first, 4) : value.second;
  }
  std::string name_;
  std::vector<Value> values_;
  bool numeric_ = false;
  std::size_t stretches_ = 1;
  double low_ = 0.0, width_ = 0.0;  // of the stretches; 0: each value is a group
};

std::vector<Axis> axes_of(std::span<const SweptRun> runs) {
  std::vector<Axis> axes;
  for (const auto& [name, value] : runs.front().values) {
    Axis axis(runs, name);
    if (axis.usable()) axes.push_back(std::move(axis));
  }
  return axes;
}

// How much of the squares' sum of `what` lies between the groups of an axis: how much the axis matters.
template <typename What>
double spread(std::span<const SweptRun> runs, const Axis& axis, const What& what) {
  std::vector<double> sums(axis.groups(), 0.0), counts(axis.groups(), 0.0);
  double sum = 0.0, count = 0.0;
  for (const auto& run : runs) {
    const auto group = axis.group(run);
    const std::optional<double> value = what(run);
    if (!group || !value) continue;
    sums[*group] += *value;
    counts[*group] += 1.0;
    sum += *value;
    count += 1.0;
  }
  double between = 0.0;
  for (std::size_t i = 0; i < sums.size(); ++i)
    if (counts[i] > 0.0) between += counts[i] * std::pow(sums[i] / counts[i] - sum / count, 2);
  return between;
}

// The axes by how much they matter, the most first; where they matter alike, in the sweep's order.
template <typename What>
std::vector<const Axis*> ranked(std::span<const SweptRun> runs, const std::vector<Axis>& axes,
                                const What& what) {
  std::vector<std::pair<double, const Axis*>> found;
  for (const auto& axis : axes) found.emplace_back(spread(runs, axis, what), &axis);
  std::ranges::stable_sort(found, std::greater(), &std::pair<double, const Axis*>::first);
  std::vector<const Axis*> order;
  for (const auto& [much, axis] : found) order.push_back(axis);
  return order;
}

std::string linked(const std::string& link, const std::string& content) {
  return link.empty() ? content : "<a href=\"" + cli::markup(link) + "\">" + content + "</a>";
}

std::string text_at(double x, double y, const char* anchor, const std::string& words) {
  return "<text x=\"" + cli::fixed(x, 1) + "\" y=\"" + cli::fixed(y, 1) + "\" text-anchor=\"" + anchor +
         "\">" + cli::markup(words) + "</text>";
}

std::string open_svg(double height, const std::string& label) {
  return "<svg class=\"figure\" viewBox=\"0 0 " + cli::fixed(kWidth, 0) + " " + cli::fixed(height, 0) +
         "\" role=\"group\" aria-label=\"" + cli::markup(label) + "\">";
}

// The runs of one cell of the map.
struct Cell {
  std::size_t passed = 0, failed = 0, invalid = 0;
  const SweptRun* shown = nullptr;  // the first that failed; else the first that is invalid; else the first

  void take(const SweptRun& run) {
    passed += run.outcome == Outcome::kPassed;
    failed += run.outcome == Outcome::kFailed;
    invalid += run.outcome == Outcome::kInvalid;
    const auto worse = [](Outcome a, Outcome b) {
      return a != b && (a == Outcome::kFailed || (a == Outcome::kInvalid && b == Outcome::kPassed));
    };
    if (!shown || worse(run.outcome, shown->outcome)) shown = &run;
  }
  std::string words() const {
    return std::to_string(passed) + " of " + std::to_string(passed + failed) + " passed" +
           (invalid > 0 ? ", " + std::to_string(invalid) + " invalid" : "");
  }
};

std::string cell_svg(const Cell& cell, double x, double y, double width, const std::string& where) {
  const std::string box = "x=\"" + cli::fixed(x, 1) + "\" y=\"" + cli::fixed(y, 1) + "\" width=\"" +
                          cli::fixed(width, 1) + "\" height=\"" + cli::fixed(kCellHeight, 0) + "\"";
  if (!cell.shown) return "<rect class=\"cell\" fill=\"none\" " + box + "/>";
  const std::size_t valid = cell.passed + cell.failed;
  const double share = valid == 0 ? 0.0 : static_cast<double>(cell.passed) / static_cast<double>(valid);
  const std::string fill = valid == 0 ? "fill:none"
                                      : "fill:color-mix(in srgb,var(--good) " + cli::fixed(100.0 * share, 0) +
                                            "%,var(--bad));fill-opacity:.45";
  const std::string words = valid == 0 ? "?" : std::to_string(cell.passed) + "/" + std::to_string(valid);
  return linked(cell.shown->link,
                "<rect class=\"cell\" style=\"" + fill + "\" " + box + "><title>" +
                    cli::markup(where + ": " + cell.words() + "; run " + std::to_string(cell.shown->run)) +
                    "</title></rect>" + text_at(x + width / 2, y + kCellHeight / 2 + 4, "middle", words));
}

std::string map_of(std::span<const SweptRun> runs, const Axis& across, const Axis& down) {
  std::vector<Cell> cells(across.groups() * down.groups());
  for (const auto& run : runs) {
    const auto column = across.group(run), row = down.group(run);
    if (column && row) cells[*row * across.groups() + *column].take(run);
  }
  const double width = (kWidth - kLeft - kRight) / static_cast<double>(across.groups());
  const double foot = kTop + kCellHeight * static_cast<double>(down.groups());
  std::string svg =
      open_svg(foot + kBottom, "Runs that passed over " + across.name() + " and " + down.name());
  for (std::size_t row = 0; row < down.groups(); ++row) {
    // The greatest value stands above, as on any diagram
    const double y = foot - kCellHeight * static_cast<double>(row + 1);
    svg += text_at(kLeft - 6, y + kCellHeight / 2 + 4, "end", down.label(row));
    for (std::size_t column = 0; column < across.groups(); ++column)
      svg += cell_svg(
          cells[row * across.groups() + column], kLeft + width * static_cast<double>(column), y, width,
          across.name() + " " + across.label(column) + ", " + down.name() + " " + down.label(row));
  }
  for (std::size_t column = 0; column < across.groups(); ++column)
    svg += text_at(kLeft + width * (static_cast<double>(column) + 0.5), foot + 14, "middle",
                   width > 70 || column % 2 == 0 ? across.label(column) : "");
  return svg + text_at(kWidth - kRight, foot + 29, "end", across.name() + " →") +
         text_at(4, foot + 29, "start", "↑ " + down.name()) + "</svg>\n";
}

struct Dot {
  double x, y;
  const SweptRun* run;
};

struct Scale {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  void take(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  double share(double value) const { return high > low ? (value - low) / (high - low) : 0.5; }
};

std::string dot_svg(const Dot& dot, const std::string& x, const std::string& y) {
  const char* kind = dot.run->outcome == Outcome::kPassed   ? "passed"
                     : dot.run->outcome == Outcome::kFailed ? "failed"
                                                            : "invalid";
  const std::string radius = dot.run->outcome == Outcome::kPassed ? "3" : "4.5";
  return linked(dot.run->link, "<circle class=\"" + std::string(kind) + "\" r=\"" + radius + "\" cx=\"" + x +
                                   "\" cy=\"" + y + "\"><title>run " + std::to_string(dot.run->run) + ": " +
                                   cli::readable(dot.y) + "</title></circle>");
}

// The least, mean and greatest value of each group, at its mean place.
std::string band_of(std::span<const SweptRun> runs, const std::vector<Dot>& dots, const Axis& axis,
                    const std::function<std::string(double, double)>& at) {
  struct Group {
    Scale values;
    double x = 0.0, y = 0.0, count = 0.0;
  };
  std::vector<Group> groups(axis.groups());
  for (const auto& dot : dots) {
    auto& group = groups[*axis.group(*dot.run)];
    group.values.take(dot.y);
    group.x += dot.x;
    group.y += dot.y;
    group.count += 1.0;
  }
  std::erase_if(groups, [](const Group& group) { return group.count == 0.0; });
  std::string there, back, mean;
  for (const auto& group : groups) {
    const double x = group.x / group.count;
    there += at(x, group.values.high) + " ";
    back.insert(0, at(x, group.values.low) + " ");
    mean += at(x, group.y / group.count) + " ";
  }
  const bool several = runs.size() > groups.size();
  return (several ? "<polygon class=\"band\" points=\"" + there + back + "\"/>" : "") +
         "<polyline class=\"mean\" points=\"" + mean + "\"/>";
}

std::string curve_of(std::span<const SweptRun> runs, const FigureCheck& check, const Axis& axis) {
  std::vector<Dot> dots;
  Scale across, up;
  for (const auto& run : runs) {
    const auto value = run.checks.find(check.name);
    const auto place = axis.place(run);
    if (value == run.checks.end() || !place || !std::isfinite(value->second)) continue;
    dots.push_back({*place, value->second, &run});
    across.take(*place);
    up.take(value->second);
  }
  if (dots.size() < 2) return {};
  const auto x = [&](double value) {
    return cli::fixed(kLeft + across.share(value) * (kWidth - kLeft - kRight), 1);
  };
  const auto y = [&](double value) {
    return cli::fixed(kHeight - kBottom - up.share(value) * (kHeight - kTop - kBottom), 1);
  };
  const double foot = kHeight - kBottom + 16;
  const std::string of = check.name + (check.unit.empty() ? "" : ", " + check.unit);
  std::string svg = "<h3>" + cli::markup(of) + " <small>must be " + cli::markup(check.bound) +
                    "</small></h3>\n" + open_svg(kHeight, check.name + " over " + axis.name());
  svg += "<line class=\"axis\" x1=\"" + cli::fixed(kLeft, 1) + "\" x2=\"" + cli::fixed(kWidth - kRight, 1) +
         "\" y1=\"" + cli::fixed(kHeight - kBottom, 1) + "\" y2=\"" + cli::fixed(kHeight - kBottom, 1) +
         "\"/>";
  svg += band_of(runs, dots, axis, [&](double at, double value) { return x(at) + "," + y(value); });
  if (dots.size() <= kMostDots)
    for (const auto& dot : dots) svg += dot_svg(dot, x(dot.x), y(dot.y));
  svg += text_at(kLeft - 6, kTop + 8, "end", cli::readable(up.high, 4)) +
         text_at(kLeft - 6, kHeight - kBottom, "end", cli::readable(up.low, 4));
  return svg + text_at(kLeft, foot, "start", axis.low()) +
         text_at(kWidth - kRight, foot, "end", axis.high()) +
         text_at(kWidth - kRight, foot + 14, "end", axis.name() + " →") + "</svg>\n";
}

}  // namespace

std::string sweep_figures(std::span<const SweptRun> runs, std::span<const FigureCheck> checks) {
  if (runs.size() < 2) return {};
  const auto axes = axes_of(runs);
  if (axes.empty()) return {};
  std::string html;
  if (axes.size() >= 2) {
    const auto passed = [](const SweptRun& run) {
      return run.outcome == Outcome::kInvalid ? std::nullopt
                                              : std::optional(run.outcome == Outcome::kPassed ? 1.0 : 0.0);
    };
    const auto order = ranked(runs, axes, passed);
    html +=
        "<h2>Where it passes</h2>\n<p>Runs that passed, of those that are valid, over the two parameters "
        "that matter most. A cell leads to a run of it.</p>\n" +
        map_of(runs, *order[0], *order[1]);
  }
  std::string curves;
  for (const auto& check : checks) {
    const auto value = [&](const SweptRun& run) {
      const auto found = run.checks.find(check.name);
      return found == run.checks.end() ? std::nullopt : std::optional(found->second);
    };
    curves += curve_of(runs, check, *ranked(runs, axes, value)[0]);
  }
  if (!curves.empty())
    html +=
        "<h2>Values of each check</h2>\n<p>Over the parameter that matters most for it: the mean, and the "
        "band from the least to the greatest value. A ring is a run that did not pass.</p>\n" +
        curves;
  return html;
}

}  // namespace visum::run
