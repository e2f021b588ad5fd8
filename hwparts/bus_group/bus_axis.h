// One module on a real bus as its part drives it: what is wished of it, as one request at a time, and what it
// last said. Wishes go before readings, the most urgent first; a newer wish takes the place of an older.
// Units are the module's. No allocation after construction.
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
  // As last heard. What the bus lost, or a module that is not the one that was surveyed, shows as ERROR and
  // COMM_ERROR.
  const Reading& reading() const { return reading_; }
  std::uint32_t state_word() const;
  bool has(std::uint32_t bits) const { return (state_word() & bits) != 0; }
  // Moves, or will, as far as is known: from the wish on until a state that was read afterwards says
  // otherwise.
  bool moves() const;
  // A command that changes the state is on its way, and the state is not known yet.
  bool settling() const { return unsettled_; }
  bool homing() const { return homing_; }
  bool lost() const { return lost_; }
  int module() const { return data_.module; }
  const drive::DriveData& data() const { return data_; }

  // Wishes.
  void halt();
  void reset();  // also takes a module back that was lost and answers again
  void home();
  void follow(double target, double speed);  // [u], [u]/s: a ramp; the same again is nothing new
  void stand();                              // stops what follow() began, also before a reset; once

  // A setting of the module, as SETPARAM has it. [u]
  void set(std::uint8_t parameter, double value);

  bool has_wish() const;
  // The next thing to ask, a wish or a reading.
  powercube::Message next_request();
  // What came of it; no answer: the module is lost.
  void take(const powercube::Message& request, const std::optional<powercube::Message>& answer);
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
  std::vector<powercube::Message> settings_;  // to be sent again after a loss
  std::size_t settings_left_ = 0;

  Reading reading_;
  bool lost_ = false;
  bool comm_fault_ = false;   // was lost, or refused a setting; until reset()
  bool unsettled_ = false;    // a command was given whose effect on the state is not known yet
  bool state_asked_ = false;  // since it was answered
  bool homing_ = false;
  bool move_sent_ = false;  // since the state was read last
  unsigned round_ = 0;      // of readings
  unsigned pause_ = 0;      // a motion was refused: for so many readings nothing is sent that moves it

  bool halt_wished_ = false, reset_wished_ = false, home_wished_ = false, stand_wished_ = false;
  bool halt_again_ = false;  // behind the reset that was pending when the halt came
  std::optional<float> target_wished_;
  float speed_wished_ = 0.0F;
  std::optional<float> target_sent_;  // what it follows now
  bool ramp_sent_ = false;            // and nothing since that stops it; a reset does not
  std::optional<float> speed_sent_;   // none: what the module has is not known
};

}  // namespace visum::bus_group
