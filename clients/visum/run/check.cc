#include "clients/visum/run/check.h"

#include <cmath>

#include "clients/visum/common/format.h"
#include "clients/visum/common/terminal.h"
#include "clients/visum/run/bounds.h"

namespace visum::run {
namespace {

// Steps fall on whole ticks; half a nanosecond more than any rounding of seconds to doubles within a run.
constexpr double kRounding_s = 1e-9;

std::string window_text(const Window& window) {
  if (window.kind == Window::Kind::kEnd) return "at the end";
  if (window.kind == Window::Kind::kEventually) {
    return std::isinf(window.to_s) ? "at some time" : "by " + cli::exact(window.to_s) + " s";
  }
  if (window.from_s == 0.0 && std::isinf(window.to_s)) return "always";
  std::string text = "from " + cli::exact(window.from_s) + " s";
  return std::isinf(window.to_s) ? text + " on" : text + " to " + cli::exact(window.to_s) + " s";
}

}  // namespace

std::string value_text(const CheckResult& check, int digits) {
  std::string text = cli::rounded(*check.value, digits);
  if (!check.unit.empty()) text += " " + check.unit;
  if (!check.words.empty()) text += " (" + check.words + ")";
  return text;
}

Check::Check(const CheckSpec& spec, const Catalogue& catalogue)
    : spec_(spec), quantity_(tie(spec.that.quantity, catalogue)) {}

void Check::tie_again(const Catalogue& catalogue) {
  run::tie_again(quantity_, catalogue);
}

void Check::keep(double value, double margin, double at_s) {
  value_ = value;
  margin_ = margin;
  at_s_ = at_s;
}

void Check::observe(const Observation& now) {
  const double now_s = static_cast<double>(now.world.sim_time_ns) * 1e-9;
  const Window& window = spec_.when;
  if (now_s < window.from_s - kRounding_s || now_s > window.to_s + kRounding_s) return;
  const double value = quantity_.measure(quantity_, now);
  const double inside = margin(spec_.that.bounds, value);
  const bool good = holds(spec_.that.bounds, value);
  course_.add(now_s, value);
  switch (window.kind) {
    case Window::Kind::kEnd:
      keep(value, inside, now_s);
      held_ = good;
      return;
    case Window::Kind::kAlways:
      held_ = good && (held_ || !value_);
      if (!value_ || inside < margin_) keep(value, inside, now_s);
      return;
    case Window::Kind::kEventually:
      held_ = held_ || good;
      if (!value_ || inside > margin_) keep(value, inside, now_s);
      return;
  }
}

bool Check::is_certain(double now_s) const {
  if (now_s > spec_.when.to_s + kRounding_s) return true;
  if (spec_.when.kind == Window::Kind::kAlways) return value_ && !held_;
  return spec_.when.kind == Window::Kind::kEventually && held_;
}

CheckResult Check::result() const {
  CheckResult result;
  result.text = quantity_.text;
  result.unit = quantity_.unit;
  result.bound = to_text(spec_.that.bounds, quantity_.unit);
  result.name = spec_.name.empty() ? result.text + " " + result.bound : spec_.name;
  result.passed = held_;
  result.value = value_;
  if (value_) result.margin = margin_;
  result.at_s = at_s_;
  if (value_) result.words = cli::printable(protocol::in_words(quantity_.port, *value_));
  result.limits = limits(spec_.that.bounds);
  result.course = course_.points();
  if (held_) return result;
  result.failure = result.text + " must be " + result.bound + " " + window_text(spec_.when) + ", ";
  if (!value_) {
    result.failure += "but the run had no step in that time";
  } else {
    result.failure += "is " + value_text(result, 6) + " at " + cli::fixed(at_s_, 3) + " s";
  }
  return result;
}

}  // namespace visum::run
