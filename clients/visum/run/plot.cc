#include "clients/visum/run/plot.h"

#include <algorithm>
#include <cmath>

#include "clients/visum/common/format.h"
#include "clients/visum/common/markup.h"

namespace visum::run {
namespace {

constexpr double kPlotWidth = 720.0, kHeight = 170.0;
constexpr double kLeft = 84.0, kRight = 12.0, kTop = 10.0, kBottom = 24.0;

struct Span {
  double low, high;
  void take(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
};

// Maps values to places in the picture, and writes the numbers at its edges.
class Frame {
 public:
  explicit Frame(const CheckResult& check)
      : time_{check.course.front().at_s, check.course.back().at_s},
        value_{check.course.front().lowest, check.course.front().highest} {
    for (const auto& point : check.course) {
      value_.take(point.lowest);
      value_.take(point.highest);
    }
    for (const double limit : check.limits)
      if (std::isfinite(limit)) value_.take(limit);
    const double room = std::max(0.06 * (value_.high - value_.low), 1e-9 + 1e-6 * std::abs(value_.high));
    shown_ = {value_.low - room, value_.high + room};
  }

  std::string x(double at_s) const {
    const double share = (at_s - time_.low) / std::max(time_.high - time_.low, 1e-12);
    return cli::fixed(kLeft + share * (kPlotWidth - kLeft - kRight), 1);
  }
  std::string y(double value) const {
    const double share = (value - shown_.low) / (shown_.high - shown_.low);
    return cli::fixed(kHeight - kBottom - share * (kHeight - kTop - kBottom), 1);
  }
  std::string words() const {
    return text(kLeft - 6, value_.high, "end") + text(kLeft - 6, value_.low, "end") +
           at_foot(kLeft, time_.low, "start") + at_foot(kPlotWidth - kRight, time_.high, "end");
  }

 private:
  std::string text(double x, double value, const char* anchor) const {
    return "<text x=\"" + cli::fixed(x, 1) + "\" y=\"" + y(value) + "\" dy=\"4\" text-anchor=\"" + anchor +
           "\">" + cli::rounded(value, 4) + "</text>";
  }
  static std::string at_foot(double x, double at_s, const char* anchor) {
    return "<text x=\"" + cli::fixed(x, 1) + "\" y=\"" + cli::fixed(kHeight - 6, 1) + "\" text-anchor=\"" +
           anchor + "\">" + cli::fixed(at_s, 2) + " s</text>";
  }

  Span time_, value_, shown_{0.0, 1.0};
};

// All values: a line if each point has one value, else the band between lowest and highest.
std::string band(const CheckResult& check, const Frame& frame) {
  std::string there, back;
  for (const auto& point : check.course) {
    there += frame.x(point.at_s) + "," + frame.y(point.highest) + " ";
    back.insert(0, frame.x(point.at_s) + "," + frame.y(point.lowest) + " ");
  }
  return "<polygon class=\"course\" points=\"" + there + back + "\"/>";
}

std::string limit_lines(const CheckResult& check, const Frame& frame) {
  std::string lines;
  for (const double limit : check.limits) {
    if (!std::isfinite(limit)) continue;
    lines += "<line class=\"limit\" x1=\"" + cli::fixed(kLeft, 1) + "\" x2=\"" +
             cli::fixed(kPlotWidth - kRight, 1) + "\" y1=\"" + frame.y(limit) + "\" y2=\"" + frame.y(limit) +
             "\"/>";
  }
  return lines;
}

std::string mark(const CheckResult& check, const Frame& frame) {
  if (!check.value || !std::isfinite(*check.value)) return {};
  return "<circle class=\"worst\" r=\"3.5\" cx=\"" + frame.x(check.at_s) + "\" cy=\"" +
         frame.y(*check.value) + "\"/>";
}

}  // namespace

std::string plot(const CheckResult& check) {
  if (check.course.size() < 2) return {};
  const Frame frame(check);
  return "<svg viewBox=\"0 0 " + cli::fixed(kPlotWidth, 0) + " " + cli::fixed(kHeight, 0) +
         "\" role=\"img\" aria-label=\"" + cli::markup(check.name) + "\">" + limit_lines(check, frame) +
         band(check, frame) + mark(check, frame) + frame.words() + "</svg>\n";
}

}  // namespace visum::run
