// Inputs: everything that changes a world between its ticks, as plain values. A world that gets the same
// inputs in the same order between the same ticks goes through the same bits. Texts, numbers and bytes are
// views; they are valid only during the call that passes them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <variant>

#include "protocol/part_description.h"
#include "protocol/reset_scope.h"

namespace visum::recording {

struct State;
struct SpawnedModel;
struct LoadedScene;

struct WriteInputs {
  std::string_view part;
  std::uint32_t first_port = 0;
  std::span<const double> values;
};
// The part's controller is gone without a release, or it missed the deadline that it asked for.
struct LoseController {
  std::string_view part;
};
struct SetParameter {
  std::string_view part, name;
  protocol::ParameterValue value;
};
struct WriteBlackboard {
  std::string_view part, name;
  std::uint64_t offset = 0;
  std::span<const std::byte> data;
};
// A telegram that a field bus brought to the part's modules.
struct BusTelegram {
  std::string_view part;
  std::uint8_t wire = 0, kind = 0, module = 0;  // numbers as in hwparts/powercube/message.h
  std::span<const std::byte> data;              // at most 8 bytes
};
struct PushBody {
  std::int32_t body = 0;                         // its number in the world at that time
  std::array<double, 3> force_n{}, torque_nm{};  // in the world's frame W, about the centre of mass
  std::int64_t until_tick = 0;
};
// A fault that is caused on purpose: its kind by name, and all numbers of that kind in their order.
struct InjectFault {
  std::string_view part, kind;
  std::span<const double> numbers;
  std::int64_t until_tick = 0;  // 0: until it is cleared
};
struct ClearFault {
  std::string_view part, kind;  // no kind: all faults of the part
  std::uint32_t drive = 0;      // from 1; 0: all drives
};
// A body was put elsewhere, or got another velocity.
struct SetBody {
  std::int32_t body = 0;                            // its number in the world at that time
  bool moves = false;                               // false: it stays where it is, and `pose` means nothing
  std::array<double, 7> pose{0, 0, 0, 1, 0, 0, 0};  // x y z qw qx qy qz of its link frame, in W
  std::array<double, 3> velocity{}, turn_rate{};    // of the link frame's origin, in W
};
// Joints were set; all three have the same length.
struct SetJoints {
  std::span<const std::int32_t> joints;  // their numbers in the world at that time
  std::span<const double> positions, velocities;
};
struct PullBody {
  std::int32_t body = 0;
  std::array<double, 3> point{}, target{};  // in the body's link frame; in W
  double max_force_n = 0.0;
  std::int64_t until_tick = 0;  // 0: until it is released
};
struct ReleaseBody {
  std::int32_t body = 0;
};
struct Reset {
  protocol::ResetScope scope = protocol::ResetScope::kWorld;
};
struct TakeSnapshot {
  std::uint64_t number = 0;
};
struct RestoreSnapshot {
  std::uint64_t number = 0;
};
// The world as a snapshot on disk has it; never null.
struct RestoreState {
  const State* state = nullptr;
};
struct AddBody {
  std::string_view yaml;
};
struct RemoveBody {
  std::string_view name;
};
struct SpawnModel {
  std::shared_ptr<const SpawnedModel> model;  // never null
};
struct RemoveModel {
  std::string_view name;
};
// Another scene took the world's place.
struct LoadScene {
  std::shared_ptr<const LoadedScene> scene;  // never null
};

using Input =
    std::variant<WriteInputs, LoseController, SetParameter, WriteBlackboard, BusTelegram, PushBody, Reset,
                 TakeSnapshot, RestoreSnapshot, AddBody, RemoveBody, InjectFault, ClearFault, SetBody,
                 SetJoints, PullBody, ReleaseBody, RestoreState, SpawnModel, RemoveModel, LoadScene>;

// An input, and the tick and era in which the world took it.
struct TimedInput {
  std::int64_t tick = 0;
  std::uint64_t era = 0;
  Input input;
};

}  // namespace visum::recording
