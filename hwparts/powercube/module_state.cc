#include "hwparts/powercube/module_state.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "hwparts/drive/state_word.h"
#include "hwparts/drive/supervision.h"
#include "hwparts/powercube/parameters.h"

namespace visum::powercube {
namespace {

namespace bit = drive::state_bit;

// The reference switch is on over this distance below home. A guess.
constexpr double kCam_rad = 0.02, kCam_m = 0.001;

// Calls `visit` for every field once: save() and load() thus agree. StateWriter::put_run() needs it
// inlined.
template <typename State, typename Visit>
[[gnu::always_inline]] inline void visit_fields(State& s, Visit visit) {
  visit(s.address), visit(s.config), visit(s.target_speed), visit(s.target_acceleration);
  visit(s.target_position), visit(s.move_mode), visit(s.previous_position), visit(s.saved_position);
  visit(s.outputs), visit(s.burn_count), visit(s.deferred);
  drive::visit_motion(s.deferred_motion, visit);
  visit(s.watchdog_armed), visit(s.watchdog_s), visit(s.state_s), visit(s.state_sent);
  for (auto& value : s.kept) visit(value);
}

}  // namespace

ModuleState initial_state(const Settings& settings, const drive::DriveData& data, double position) {
  ModuleState state;
  state.address = static_cast<std::uint8_t>(data.module);
  state.config = settings.config;
  state.target_speed = data.limits.maximum_speed;
  state.target_acceleration = data.limits.maximum_acceleration;
  state.target_position = state.previous_position = position;
  state.kept = factory_values(data);
  return state;
}

void save(const ModuleState& state, hwparts::StateWriter& to) {
  to.put_run(sizeof state,
             [&](auto& run) { visit_fields(state, [&](const auto& field) { run.put(field); }); });
}

void load(ModuleState& state, hwparts::StateReader& from) {
  visit_fields(state, [&](auto& field) { from.get(field); });
}

std::uint32_t state_word(const ModuleView& view) {
  const auto config = view.module.config;
  const double position = drive::switch_position(view.drive);
  const double below_home = view.data.home.position - position;
  // At home itself the axis has just left the switch.
  const bool on_cam =
      below_home > view.data.increment() && below_home < (view.data.linear ? kCam_m : kCam_rad);
  std::uint32_t word = drive::state_word(view.drive);
  if ((config & config_bit::kSwrEnabled) && on_cam) word |= bit::kSwr;
  if (!view.data.limits.limited) return word;
  if ((config & config_bit::kSw1Enabled) && position < view.data.limits.hard_minimum) word |= bit::kSw1;
  if ((config & config_bit::kSw2Enabled) && position > view.data.limits.hard_maximum) word |= bit::kSw2;
  return word;
}

std::uint8_t short_state(const ModuleView& view) {
  struct Pair {
    std::uint32_t in_word;
    std::uint8_t in_byte;
  };
  constexpr Pair kPairs[] = {{bit::kError, 0x01},   {bit::kHalted, 0x01},     {bit::kSwr, 0x02},
                             {bit::kSw1, 0x04},     {bit::kSw2, 0x08},        {bit::kMotion, 0x10},
                             {bit::kRampEnd, 0x20}, {bit::kInProgress, 0x40}, {bit::kFullBuffer, 0x80}};
  const auto word = state_word(view);
  std::uint8_t byte = word & bit::kHomeOk ? 0x00 : 0x01;
  for (const auto& pair : kPairs)
    if (word & pair.in_word) byte |= pair.in_byte;
  return byte;
}

std::uint8_t dio_byte(const ModuleView& view) {
  return view.module.outputs;
}

std::uint32_t dio_word(const ModuleView& view) {
  const auto word = state_word(view);
  return static_cast<std::uint32_t>(dio_byte(view)) | (word & bit::kSwr ? 0x100u : 0u) |
         (word & bit::kSw1 ? 0x200u : 0u) | (word & bit::kSw2 ? 0x400u : 0u);
}

std::int32_t to_increments(const ModuleView& view, double value) {
  constexpr double kLeast = std::numeric_limits<std::int32_t>::min(),
                   kMost = std::numeric_limits<std::int32_t>::max();
  return static_cast<std::int32_t>(std::clamp(std::round(value / view.data.increment()), kLeast, kMost));
}

double from_increments(const ModuleView& view, double increments) {
  return increments * view.data.increment();
}

}  // namespace visum::powercube
