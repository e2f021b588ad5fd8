#include "hwparts/powercube/module.h"

#include "hwparts/drive/state_word.h"
#include "hwparts/drive/supervision.h"
#include "hwparts/powercube/moves.h"
#include "hwparts/powercube/parameters.h"

namespace visum::powercube {
namespace {

namespace bit = drive::state_bit;

// Clears faults and Halt. HOME_OK, position and parameters stay, except target speed and acceleration, which
// go back to their maxima.
void reset(const ModuleEdit& edit) {
  const auto& drive = edit.drive.state();
  edit.drive.reset();
  if (drive.referenced) edit.drive.apply_home_offset();
  edit.module.target_speed = drive.tuning.maximum_speed;
  edit.module.target_acceleration = drive.tuning.maximum_acceleration;
  edit.module.watchdog_armed = false;
  edit.module.deferred = false;
}

void halt(const ModuleEdit& edit) {
  edit.drive.halt_by_bus();
  edit.module.deferred = false;
}

// Homing is answered, but not done while nothing may move: otherwise it would begin by itself once motion is
// allowed again.
void home(const ModuleEdit& edit) {
  if (edit.enabled && edit.drive.home_by_bus()) edit.module.deferred = false;
}

// The answer that refuses a command, or silence, as the settings say.
std::optional<Message> refusal(const ModuleView& view, std::uint8_t command, std::uint8_t what) {
  if (!view.settings.answers_refused) return std::nullopt;
  return Message{command, what, view.settings.refused_byte};
}

std::optional<Message> obey_parameter(const ModuleEdit& edit, const Message& message) {
  if (message.size < 2) return std::nullopt;
  if (set_parameter(edit, message) == SetResult::kDone)
    return Message{command::kSetParameter, message.data[1], kDone};
  return refusal(edit, command::kSetParameter, message.data[1]);
}

// The answer to an extended motion command: position, state and inputs as of now.
Message extended_answer(const ModuleView& view, const Message& message, const Move& move) {
  Message answer{command::kSetMove, message.data[1]};
  if (move.increments) {
    put_value(answer, to_increments(view, view.drive.measured_position));
  } else {
    put_value(answer, static_cast<float>(view.drive.measured_position));
  }
  answer.put(short_state(view));
  answer.put(dio_byte(view));
  return answer;
}

std::optional<Message> execute_move(const ModuleEdit& edit, const Message& message, BusFraming framing) {
  const auto move = read_move(edit, message);
  if (!move) return std::nullopt;
  const bool deferred = framing == BusFraming::kCan && (edit.module.config & config_bit::kSyncMotion) != 0;
  const bool done = start(edit, *move, deferred) == MoveResult::kDone;
  if (done) edit.module.move_mode = message.data[1];
  if (!done && !edit.settings.answers_refused) return std::nullopt;
  if (move->extended) return extended_answer(edit, message, *move);
  if (!done) return refusal(edit, command::kSetMove, message.data[1]);
  return Message{command::kSetMove, message.data[1], kDone};
}

std::optional<Message> carry_out(const ModuleEdit& edit, const Message& message, BusFraming framing) {
  switch (message.command()) {
    case command::kReset:
      reset(edit);
      return Message{command::kReset};
    case command::kHome:
      home(edit);
      return Message{command::kHome};
    case command::kHalt:
      halt(edit);
      return Message{command::kHalt};
    case command::kRecalcPid:
      recalculate_loop(edit);
      return Message{command::kRecalcPid};
    case command::kSaveParameters:
      ++edit.module.burn_count;
      return Message{command::kSaveParameters};
    case command::kSetParameter:
      return obey_parameter(edit, message);
    case command::kSetMove:
      return execute_move(edit, message, framing);
    default:
      return std::nullopt;
  }
}

}  // namespace

std::optional<Message> execute(const ModuleEdit& edit, const Message& message, BusFraming framing) {
  if (message.size == 0) return std::nullopt;
  if (message.command() == command::kGetParameter)
    return message.size == 2 ? get_parameter(edit, message.data[1]) : std::nullopt;
  const bool mute = framing == BusFraming::kCan && (edit.module.config & config_bit::kDisableAck) != 0;
  const auto answer = carry_out(edit, message, framing);
  return mute ? std::nullopt : answer;
}

// m5api sends broadcasts with a zero behind the command; KTH and Georgia Tech send them without.
void execute_broadcast(const ModuleEdit& edit, const Message& message, BusFraming framing) {
  if (message.size == 0 || (framing == BusFraming::kSerial && !edit.settings.serial_broadcasts)) return;
  switch (message.command()) {
    case command::kReset:
      return reset(edit);
    case command::kHome:
      return home(edit);
    case command::kHalt:
      return halt(edit);
    case command::kWatchdog:
      edit.module.watchdog_armed = (edit.module.config & config_bit::kWatchdogEnable) != 0;
      edit.module.watchdog_s = 0.0;
      return;
    case command::kSavePosition:
      edit.module.saved_position = edit.drive.state().measured_position;
      return;
    case command::kStartMove:
      return start_deferred(edit);
    default:
      return;  // baud rate and time: a virtual line has no rate to change, and nothing here uses the time
  }
}

void tick(const ModuleEdit& edit, double tick_s) {
  auto& module = edit.module;
  module.previous_position = edit.drive.state().measured_position;
  if (module.watchdog_armed) {
    module.watchdog_s += tick_s;
    if (module.watchdog_s > edit.settings.watchdog_s) {
      module.watchdog_armed = false;
      edit.drive.lose_controller();
    }
  }
  const auto& drive = edit.drive.state();
  const bool halted = drive::has(drive, bit::kHalted) && (module.config & config_bit::kDisableOnHalt);
  if (halted && drive.setpoint.phase == drive::RampPhase::kEnd) edit.drive.open_loop();
}

std::optional<Message> spontaneous_state(const ModuleEdit& edit, double tick_s) {
  auto& module = edit.module;
  if (!(module.config & config_bit::kSyncTransmit) || edit.settings.firmware < 0x3600) return std::nullopt;
  module.state_s += tick_s;
  const auto word = state_word(edit);
  if (word == module.state_sent && module.state_s < edit.settings.state_period_s) return std::nullopt;
  module.state_s = 0.0;
  module.state_sent = word;
  Message message;
  put_value(message, word);
  return message;
}

}  // namespace visum::powercube
