// The blackboard `Trajectory` of a group of servos: way-points with times, which the group follows from the
// moment they are written. Little-endian doubles; a row for each way-point:
//
//   time [s], counted from the write; then a value for each desired position of the part, in the order of its
//   ports
//
// Between two way-points each joint moves along a cubic curve, so that its speed is continuous. It begins
// and ends at rest. Belongs to its part, on the tick's thread; no tick allocates.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "hwparts/servo_group/port_layout.h"
#include "hwparts/state_archive.h"

namespace visum::servo_group {

class Trajectory {
 public:
  static constexpr std::size_t kMostPoints = 1024;
  // Ticks come in whole numbers, so it is told in ticks how long a step of the drives is.
  static constexpr double kStep_s = 0.01;

  // `layout` must outlive it.
  Trajectory(const PortLayout& layout, double tick_s);

  protocol::Blackboard board() const;
  std::span<const std::byte> bytes() const { return std::as_bytes(std::span(rows_)); }

  // Where a channel is, and what its drive can do.
  struct Ability {
    double position, speed, acceleration;
  };
  // Takes a new content, and runs from now on if it has way-points. Returns why it cannot be, with row and
  // port; nothing if it is taken. `abilities`: by channel.
  std::optional<std::string> write(std::uint64_t offset, std::span<const std::byte> data,
                                   std::span<const Ability> abilities);
  bool is_empty() const { return rows_.empty(); }

  void stop() { elapsed_ticks_ = -1; }
  bool is_running() const { return elapsed_ticks_ >= 0; }
  bool has_begun() const { return elapsed_ticks_ > 0; }

  // One tick. True if a step of the drives begins with it.
  bool begins_step() const { return elapsed_ticks_ % step_ticks_ == 0; }
  double step_s() const { return static_cast<double>(step_ticks_) * tick_s_; }
  // The position of a channel at the end of the step that begins now.
  double target(std::size_t channel) const;
  // Ends the tick, and the run with its last step.
  void tick();

  void save(hwparts::StateWriter& to) const;
  void load(hwparts::StateReader& from);
  void clear();

 private:
  std::size_t width() const { return 1 + layout_.channels.size(); }
  std::size_t points() const { return rows_.size() / width(); }
  // The time and the position of a point; point 0 is the start.
  double time_of(std::size_t point) const;
  double position_of(std::size_t point, std::size_t channel) const;
  double speed_of(std::size_t point, std::size_t channel) const;
  // The highest speed and acceleration of a channel on its way to a point.
  double peak_speed(std::size_t point, std::size_t channel) const;
  double peak_acceleration(std::size_t point, std::size_t channel) const;
  std::optional<std::string> refuse_rows() const;
  std::optional<std::string> refuse_motion(std::span<const Ability> abilities) const;

  const PortLayout& layout_;
  double tick_s_;
  std::int64_t step_ticks_;
  std::vector<double> rows_, start_;
  std::int64_t elapsed_ticks_ = -1;  // -1: it does not run
};

}  // namespace visum::servo_group
