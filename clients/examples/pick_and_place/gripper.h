// The gripper: opens, closes until something stops the fingers, and notices when what it holds is gone.
// Fingers close towards the centre plane; the drive's force holds what is between them.
#pragma once

#include "clients/examples/pick_and_place/arm.h"

namespace visum::pick_and_place {

class Gripper {
 public:
  // `upper`: how far a finger can open [m]; `squeeze`: how much closer than the object's side it is told to
  // go.
  Gripper(Arm& arm, double upper_m, double squeeze_m = 0.0012)
      : arm_(arm), upper_m_(upper_m), squeeze_m_(squeeze_m) {}

  // Opens to leave some room beside an object that is `width` wide; returns when the fingers stand there.
  void open_for(double width_m);
  // Closes on an object that is `width` wide. True: something holds the fingers apart. False: nothing is
  // there.
  bool close_on(double width_m);
  // Whether the fingers still stand apart, as they did when close_on() said true.
  bool holds() const;

 private:
  void wait_until_still();

  Arm& arm_;
  double upper_m_;
  double squeeze_m_;
  double desired_m_ = 0.0;
};

}  // namespace visum::pick_and_place
