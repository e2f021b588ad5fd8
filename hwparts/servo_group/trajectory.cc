#include "hwparts/servo_group/trajectory.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "hwparts/part.h"
#include "protocol/config/number_text.h"

namespace visum::servo_group {

Trajectory::Trajectory(const PortLayout& layout, double tick_s)
    : layout_(layout),
      tick_s_(tick_s),
      step_ticks_(std::max<std::int64_t>(1, std::llround(kStep_s / tick_s))),
      start_(layout.channels.size()) {
  rows_.reserve(kMostPoints * width());
}

protocol::Blackboard Trajectory::board() const {
  const std::uint64_t element = width() * sizeof(double);
  return {"Trajectory", "application/x-visum-trajectory", element, points(), kMostPoints * element, true};
}

std::optional<std::string> Trajectory::refuse_rows() const {
  for (std::size_t point = 1; point <= points(); ++point) {
    const std::string row = "row " + std::to_string(point) + ": ";
    if (!(time_of(point) > time_of(point - 1) && time_of(point) <= 1e6))
      return row + "its time must be later than the one before, and above 0 s";
    for (std::size_t i = 0; i < layout_.channels.size(); ++i) {
      const auto& port = layout_.controller_inputs[layout_.channels[i].desired];
      const double value = position_of(point, i);
      if (!(value >= port.minimum && value <= port.maximum))
        return row + port.name + " must be within " + config::number_text(port.minimum) + " and " +
               config::number_text(port.maximum) + " " + port.unit;
    }
  }
  return std::nullopt;
}

std::optional<std::string> Trajectory::refuse_motion(std::span<const Ability> abilities) const {
  constexpr double kTolerance = 1.001;  // for what rounding adds
  const auto refusal = [this](std::size_t point, std::size_t channel, const char* what, double needed,
                              double most) {
    const auto& port = layout_.controller_inputs[layout_.channels[channel].desired];
    return "row " + std::to_string(point) + ": " + port.name + " needs the " + what + " " +
           config::number_text(needed) + " on its way there, and has " + config::number_text(most) +
           "; give it more time";
  };
  for (std::size_t point = 1; point <= points(); ++point) {
    for (std::size_t i = 0; i < layout_.channels.size(); ++i) {
      const double speed = peak_speed(point, i), acceleration = peak_acceleration(point, i);
      if (speed > kTolerance * abilities[i].speed)
        return refusal(point, i, "speed", speed, abilities[i].speed);
      if (acceleration > kTolerance * abilities[i].acceleration)
        return refusal(point, i, "acceleration", acceleration, abilities[i].acceleration);
    }
  }
  return std::nullopt;
}

std::optional<std::string> Trajectory::write(std::uint64_t offset, std::span<const std::byte> data,
                                             std::span<const Ability> abilities) {
  const std::uint64_t capacity = kMostPoints * width() * sizeof(double);
  if (offset > capacity || data.size() > capacity - offset)
    return "a trajectory has at most " + std::to_string(kMostPoints) + " way-points";
  std::vector<std::byte> content(bytes().begin(), bytes().end());
  if (!hwparts::write_into(content, offset, data)) return "the write begins beyond the content";
  if (content.size() % (width() * sizeof(double)) != 0)
    return "a row has " + std::to_string(width()) + " doubles: a time, and a value for each desired position";
  const auto rows_before = rows_, start_before = start_;
  rows_.resize(content.size() / sizeof(double));
  if (!rows_.empty()) std::memcpy(rows_.data(), content.data(), content.size());
  std::ranges::transform(abilities, start_.begin(), &Ability::position);
  auto reason = refuse_rows();
  if (!reason) reason = refuse_motion(abilities);
  if (reason) {
    std::ranges::copy(start_before, start_.begin());
    rows_.assign(rows_before.begin(), rows_before.end());
    return reason;
  }
  elapsed_ticks_ = is_empty() ? -1 : 0;
  return std::nullopt;
}

// The acceleration of a cubic curve is a line, so its largest magnitude is at an end.
double Trajectory::peak_acceleration(std::size_t point, std::size_t channel) const {
  const double length = time_of(point) - time_of(point - 1);
  const double way = (position_of(point, channel) - position_of(point - 1, channel)) / length;
  const double leave = speed_of(point - 1, channel), arrive = speed_of(point, channel);
  return std::max(std::abs(6.0 * way - 4.0 * leave - 2.0 * arrive),
                  std::abs(6.0 * way - 2.0 * leave - 4.0 * arrive)) /
         length;
}

// At an end, or where the acceleration is 0.
double Trajectory::peak_speed(std::size_t point, std::size_t channel) const {
  const double length = time_of(point) - time_of(point - 1);
  const double way = (position_of(point, channel) - position_of(point - 1, channel)) / length;
  const double leave = speed_of(point - 1, channel), arrive = speed_of(point, channel);
  const double first = 6.0 * way - 4.0 * leave - 2.0 * arrive;  // the acceleration at the start, times length
  const double last = 2.0 * leave + 4.0 * arrive - 6.0 * way;
  double peak = std::max(std::abs(leave), std::abs(arrive));
  if (first * last < 0.0) {
    const double u = first / (first - last);
    peak = std::max(peak, std::abs(leave + first * u + 0.5 * (last - first) * u * u));
  }
  return peak;
}

double Trajectory::time_of(std::size_t point) const {
  return point == 0 ? 0.0 : rows_[(point - 1) * width()];
}

double Trajectory::position_of(std::size_t point, std::size_t channel) const {
  return point == 0 ? start_[channel] : rows_[(point - 1) * width() + 1 + channel];
}

// At a point between two others: the slope from the one to the other; none where the way turns back.
double Trajectory::speed_of(std::size_t point, std::size_t channel) const {
  if (point == 0 || point == points()) return 0.0;
  const double here = position_of(point, channel);
  const double before = here - position_of(point - 1, channel);
  const double after = position_of(point + 1, channel) - here;
  if (before * after <= 0.0) return 0.0;
  return (before + after) / (time_of(point + 1) - time_of(point - 1));
}

double Trajectory::target(std::size_t channel) const {
  const double time = static_cast<double>(elapsed_ticks_) * tick_s_ + step_s();
  std::size_t end = 1;
  while (end < points() && time_of(end) < time) ++end;
  const double length = time_of(end) - time_of(end - 1);
  const double u = std::clamp((time - time_of(end - 1)) / length, 0.0, 1.0);
  const double from = position_of(end - 1, channel), to = position_of(end, channel);
  const double leave = length * speed_of(end - 1, channel), arrive = length * speed_of(end, channel);
  const double u2 = u * u, u3 = u2 * u;
  return from + (to - from) * (3.0 * u2 - 2.0 * u3) + leave * (u3 - 2.0 * u2 + u) + arrive * (u3 - u2);
}

void Trajectory::tick() {
  ++elapsed_ticks_;
  const double time = static_cast<double>(elapsed_ticks_) * tick_s_;
  if (begins_step() && time >= time_of(points())) stop();
}

void Trajectory::clear() {
  rows_.clear();
  stop();
}

void Trajectory::save(hwparts::StateWriter& to) const {
  to.put(static_cast<std::uint64_t>(rows_.size()));
  to.put(std::span<const double>(rows_));
  to.put(std::span<const double>(start_));
  to.put(elapsed_ticks_);
}

void Trajectory::load(hwparts::StateReader& from) {
  std::uint64_t size = 0;
  from.get(size);
  from.expect(size > kMostPoints * width() ? ~std::uint64_t{0} : size * sizeof(double));
  rows_.resize(size);
  from.get(std::span(rows_));
  from.get(std::span(start_));
  from.get(elapsed_ticks_);
}

}  // namespace visum::servo_group
