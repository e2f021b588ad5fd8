// What changes a world between its ticks: all of it, as plain values. A world that gets the same inputs in
// the same order between the same ticks goes through the same bits. Texts and numbers are views: they live as
// long as the call that hands them over.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <variant>

#include "protocol/part_description.h"

namespace visum::recording {

struct WriteInputs {
  std::string_view part;
  std::uint32_t first_port = 0;
  std::span<const double> values;
};
// The part's controller is gone without a release, or missed the deadline that it asked for.
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
// A telegram that came over a field bus to the part's modules.
struct BusTelegram {
  std::string_view part;
  std::uint8_t wire = 0, kind = 0, module = 0;  // numbers as in hwparts/powercube/message.h
  std::span<const std::byte> data;              // at most 8
};
struct PushBody {
  std::int32_t body = 0;                         // by its number in the world as it is
  std::array<double, 3> force_n{}, torque_nm{};  // in W, about the centre of mass
  std::int64_t until_tick = 0;
};
// A fault on purpose: its kind by name, with all numbers of that kind in their order.
struct InjectFault {
  std::string_view part, kind;
  std::span<const double> numbers;
  std::int64_t until_tick = 0;  // 0: until it is cleared
};
struct ClearFault {
  std::string_view part, kind;  // no kind: all faults of the part
  std::uint32_t drive = 0;      // from 1; 0: of all drives
};
struct Reset {};
struct TakeSnapshot {
  std::uint64_t number = 0;
};
struct RestoreSnapshot {
  std::uint64_t number = 0;
};
struct AddBody {
  std::string_view yaml;
};
struct RemoveBody {
  std::string_view name;
};

using Input =
    std::variant<WriteInputs, LoseController, SetParameter, WriteBlackboard, BusTelegram, PushBody, Reset,
                 TakeSnapshot, RestoreSnapshot, AddBody, RemoveBody, InjectFault, ClearFault>;

// An input, and where the world stood when it took it.
struct TimedInput {
  std::int64_t tick = 0;
  std::uint64_t era = 0;
  Input input;
};

}  // namespace visum::recording
