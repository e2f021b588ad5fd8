// The arm's part in closed loop, with a host on its field bus that sends requests and gets answers. Ticked by
// hand.
#pragma once

#include <gtest/gtest.h>

#include <optional>
#include <string>

#include "hwparts/drive/state_word.h"
#include "hwparts/powercube/module_bus.h"
#include "tests/hwparts/part_bench.h"
#include "tests/hwparts/rig.h"

namespace visum::test {

namespace bit = drive::state_bit;
using powercube::BusFraming;
using powercube::Message;
using powercube::Telegram;

template <typename T>
Message with_value(std::initializer_list<std::uint8_t> head, T value) {
  Message message(head);
  powercube::put_value(message, value);
  return message;
}

// Keys of an arm whose modules are not homed, and count from where they were switched on.
inline const std::string kIncrementalModules = "homed: false, modules: {counts_from_zero: true}";

class BusBench : public PartBench {
 public:
  // `more`: further keys of the part, "homed: false, modules: {...}".
  explicit BusBench(const std::string& more = "", double tick_s = 0.001, double angle = 0.0)
      : PartBench("amtec_arm", arm_context(tick_s, angle, 0.017, more.empty() ? "" : ", " + more)) {}

  // Sends a message as a client does it on a serial line, or on CAN with the right id. Returns the answer.
  std::optional<Message> send(int module, const Message& message, BusFraming framing = BusFraming::kSerial) {
    using Kind = Telegram::Kind;
    const bool reads = message.command() == powercube::command::kGetParameter;
    const auto kind = module == 0 ? Kind::kBroadcast : reads ? Kind::kGet : Kind::kSet;
    const auto answer = part->modules()->handle({kind, static_cast<std::uint8_t>(module), message}, framing);
    if (!answer) return std::nullopt;
    EXPECT_EQ(answer->kind, Kind::kAnswer);
    EXPECT_EQ(answer->module, module);
    return answer->message;
  }
  void broadcast(const Message& message, BusFraming framing = BusFraming::kSerial) {
    EXPECT_EQ(send(0, message, framing), std::nullopt);
  }

  template <typename T>
  T get(int module, std::uint8_t parameter) {
    const auto answer = send(module, {0x0A, parameter});
    if (!answer || answer->size != 2 + sizeof(T) || answer->data[1] != parameter) {
      ADD_FAILURE() << "parameter " << int(parameter) << " of module " << module << " is not answered so";
      return T{};
    }
    return powercube::value_at<T>(*answer, 2);
  }
  template <typename T>
  bool set(int module, std::uint8_t parameter, T value) {
    return send(module, with_value({0x08, parameter}, value)) == Message{0x08, parameter, 0x64};
  }
  std::uint32_t word(int module) { return get<std::uint32_t>(module, 0x27); }
  float position(int module) { return get<float>(module, 0x3C); }
  bool ramp(int module, float target) {
    return send(module, with_value({0x0B, 0x04}, target)) == Message{0x0B, 0x04, 0x64};
  }
  static Message step(std::uint8_t mode, float target, std::uint16_t ms) {
    auto message = with_value({0x0B, mode}, target);
    powercube::put_value(message, ms);
    return message;
  }
  // Ticks until all of `bits` are set; false if they are not after `seconds`.
  bool wait_for(int module, std::uint32_t bits, double seconds) {
    for (double t = 0.0; t < seconds; t += tick_s) {
      if ((word(module) & bits) == bits) return true;
      tick();
    }
    return false;
  }
};

}  // namespace visum::test
