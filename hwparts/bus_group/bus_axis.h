// One module on a real bus: the commands that wait to be sent to it (*wishes*), and its last readings. The
// part asks it for one request at a time. Wishes go before readings, the most urgent one first; a newer wish
// takes the place of an older one. Units are the module's.
//
// A BusGroup owns its axes, and they live on its thread. Nothing throws: a module that does not answer is
// lost, and shows ERROR and COMM_ERROR. No allocation after construction.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "hwparts/bus_group/survey.h"
#include "hwparts/drive/drive_data.h"
#include "hwparts/powercube/message.h"

namespace visum::bus_group {

class BusAxis {
 public:
  BusAxis(const drive::DriveData& data, const Found& found);

  struct Reading {
    double position = 0.0;  // [u]
    double speed = 0.0;     // [u]/s
    double current = 0.0;   // A
    std::uint32_t state = 0;
  };
  // The last readings that arrived.
  const Reading& reading() const { return reading_; }
  // The module's state word, with ERROR and COMM_ERROR where it is lost, is another module than the one that
  // was surveyed, or refused a setting.
  std::uint32_t state_word() const;
  bool has(std::uint32_t bits) const { return (state_word() & bits) != 0; }
  // True while the module moves or will move, as far as is known: from the wish on, until a state that was
  // read afterwards says otherwise.
  bool moves() const;
  // True while a command that changes the state is on its way, so that the state is not known.
  bool settling() const { return unsettled_; }
  bool homing() const { return homing_; }
  bool lost() const { return lost_; }
  int module() const { return data_.module; }
  const drive::DriveData& data() const { return data_; }

  // ---- wishes ----

  void halt();
  // Also takes a module back that was lost and answers again.
  void reset();
  void home();
  // A ramp to `target` [u] at `speed` [u]/s. The same call again sends nothing.
  void follow(double target, double speed);
  // Stops a motion that follow() began, also one from before a reset. The same call again sends nothing.
  void stand();

  // A setting of the module, as SETPARAM has it. [u]
  void set(std::uint8_t parameter, double value);

  // ---- the bus ----

  bool has_wish() const;
  // The next request, for a wish or else for a reading.
  powercube::Message next_request();
  // Takes the answer to a request. No answer: the module is lost.
  void take(const powercube::Message& request, const std::optional<powercube::Message>& answer);
  // Marks the module as lost and drops its wishes.
  void lose();

 private:
  void take_reading(std::uint8_t parameter, const powercube::Message& answer);
  void take_state(std::uint32_t state);
  void take_serial_number(std::uint32_t number);
  void take_refusal(const powercube::Message& request);
  void forget_motion();
  powercube::Message next_reading();

  drive::DriveData data_;
  std::uint32_t serial_number_;
  std::vector<powercube::Message> settings_;  // they are sent again after a loss
  std::size_t settings_left_ = 0;             // how many, counted from the end, are still to be sent

  Reading reading_;
  bool lost_ = false;
  bool comm_fault_ = false;   // was lost, or refused a setting; until reset()
  bool unsettled_ = false;    // the effect of a command on the state is not known yet
  bool state_asked_ = false;  // the state was asked for since that command was answered
  bool homing_ = false;
  bool move_sent_ = false;  // a motion was sent since the state was last read
  unsigned round_ = 0;      // place in the round of readings
  unsigned pause_ = 0;      // after a refused motion: for so many readings no motion is sent

  bool halt_wished_ = false, reset_wished_ = false, home_wished_ = false, stand_wished_ = false;
  bool halt_again_ = false;  // halt once more, behind the reset that was pending when the halt came
  std::optional<float> target_wished_;
  float speed_wished_ = 0.0F;
  std::optional<float> target_sent_;  // the target that the module goes to now
  bool ramp_sent_ = false;            // a ramp was sent, and nothing since that stops it (a reset does not)
  std::optional<float> speed_sent_;   // nothing: the module's target speed is not known
};

}  // namespace visum::bus_group
