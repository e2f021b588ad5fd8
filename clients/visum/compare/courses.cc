#include "clients/visum/compare/courses.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "clients/visum/common/format.h"
#include "clients/visum/common/markup.h"

namespace visum::compare {
namespace {

constexpr double kWidth = 760.0, kHeight = 170.0;
constexpr double kLeft = 84.0, kRight = 12.0, kTop = 18.0, kBottom = 24.0;

using Points = std::vector<run::CoursePoint>;

// Maps time and values to places in the picture.
class Frame {
 public:
  Frame(const Points& a, const Points& b) : from_s_(a.front().at_s), to_s_(a.back().at_s) {
    low_ = a.front().lowest;
    high_ = a.front().highest;
    for (const Points* points : {&a, &b})
      for (const auto& point : *points) {
        low_ = std::min(low_, point.lowest);
        high_ = std::max(high_, point.highest);
      }
    room_ = std::max(0.06 * (high_ - low_), 1e-9 + 1e-6 * std::abs(high_));
  }

  std::string x(double at_s) const {
    const double share = std::clamp((at_s - from_s_) / std::max(to_s_ - from_s_, 1e-12), 0.0, 1.0);
    return cli::fixed(kLeft + share * (kWidth - kLeft - kRight), 1);
  }
  std::string y(double value) const {
    const double share = (value - low_ + room_) / (high_ - low_ + 2.0 * room_);
    return cli::fixed(kHeight - kBottom - share * (kHeight - kTop - kBottom), 1);
  }
  // Each point as its lowest and its highest value, which are the same where it is one tick.
  std::string line(const Points& points, const char* kind) const {
    std::string places;
    for (const auto& [at_s, lowest, highest] : points) {
      places += x(at_s) + "," + y(lowest) + " ";
      if (highest != lowest) places += x(at_s) + "," + y(highest) + " ";
    }
    return "<polyline class=\"" + std::string(kind) + "\" points=\"" + places + "\"/>";
  }
  std::string words() const {
    return text(kLeft - 6, y(high_), "end", cli::rounded(high_, 4)) +
           text(kLeft - 6, y(low_), "end", cli::rounded(low_, 4)) +
           text(kLeft, cli::fixed(kHeight - 6, 1), "start", cli::fixed(from_s_, 2) + " s") +
           text(kWidth - kRight, cli::fixed(kHeight - 6, 1), "end", cli::fixed(to_s_, 2) + " s");
  }
  std::string first(double at_s, std::int64_t tick) const {
    const std::string place = x(at_s);
    const bool late = std::stod(place) > 0.8 * kWidth;
    return "<line class=\"first\" x1=\"" + place + "\" x2=\"" + place + "\" y1=\"" + cli::fixed(kTop, 1) +
           "\" y2=\"" + cli::fixed(kHeight - kBottom, 1) + "\"/>" +
           text(std::stod(place), cli::fixed(kTop - 5, 1), late ? "end" : "start",
                "first difference: tick " + std::to_string(tick));
  }

 private:
  static std::string text(double x, const std::string& y, const char* anchor, const std::string& words) {
    return "<text x=\"" + cli::fixed(x, 1) + "\" y=\"" + y + "\" text-anchor=\"" + anchor + "\">" + words +
           "</text>";
  }
  double from_s_, to_s_, low_ = 0.0, high_ = 0.0, room_ = 1.0;
};

}  // namespace

std::string courses_svg(const PortDistance& port) {
  const Points &a = port.course_a.points(), &b = port.course_b.points();
  if (a.size() < 2 || b.size() < 2) return {};
  const Frame frame(a, b);
  return "<svg class=\"courses\" viewBox=\"0 0 " + cli::fixed(kWidth, 0) + " " + cli::fixed(kHeight, 0) +
         "\" role=\"img\" aria-label=\"" + cli::markup(port.port) +
         " in A and B\"><rect class=\"frame\" x=\"" + cli::fixed(kLeft, 1) + "\" y=\"" + cli::fixed(kTop, 1) +
         "\" width=\"" + cli::fixed(kWidth - kLeft - kRight, 1) + "\" height=\"" +
         cli::fixed(kHeight - kTop - kBottom, 1) + "\"/>" + frame.line(a, "a") + frame.line(b, "b") +
         frame.first(port.first_s, port.tick) + frame.words() + "</svg>\n";
}

}  // namespace visum::compare
