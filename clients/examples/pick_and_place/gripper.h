// The gripper. It opens, closes until something stops the fingers, and notices when the object is gone.
// Fingers close towards the centre plane, and the drive's force holds the object between them.
#pragma once

#include "clients/examples/pick_and_place/arm.h"

namespace visum::pick_and_place {

class Gripper {
 public:
  // `upper`: how far a finger can open [m]; `squeeze`: how much closer than the object's side a finger is
  // commanded to go.
  Gripper(Arm& arm, double upper_m, double squeeze_m = 0.0012)
      : arm_(arm), upper_m_(upper_m), squeeze_m_(squeeze_m) {}

  // Opens so that some room is left beside an object of this width. Returns when the fingers stand there.
  void open_for(double width_m);
  // Closes on an object of this width. Returns true if something holds the fingers apart, and false if
  // nothing is there.
  bool close_on(double width_m);
  // Tells whether the fingers still stand as far apart as when close_on() returned true.
  bool holds() const;

 private:
  void wait_until_still();

  Arm& arm_;
  double upper_m_;
  double squeeze_m_;
  double desired_m_ = 0.0;
};

}  // namespace visum::pick_and_place
