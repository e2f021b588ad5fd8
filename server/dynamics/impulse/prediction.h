// What a tree's joints will have to give in a step, from what they gave in the last ones: what is left to be
// solved for is small, or nothing.
//
// Symbols: F a joint's reaction; h the step's length; lambda what the joint gives at its start, which closes
// the gap at its end; P all that it gives in a step, at its start and end together; index 1, 2: the last
// step and the one before it.
//   P_1 = integral of F over step 1,  lambda = 1/h integral of (t + h - s) F(s) ds + h^2 K
// The first part is found from the line through the means P_1/h_1 and P_2/h_2 (steps of one length: 11/12 P_1
// - 5/12 P_2). K is smooth: it comes of levers and inertias that turn within a step, and of F's curvature. It
// is what the first part has missed in the last two steps, carried on as a line. Steps of a composition
// differ in length and direction; the same formulas hold. Sums P are kept, and not lambda alone, because a
// gap that was closed a step late kicks both ends of a step, once to and once fro.
// Source: Adams' way to integrate (Hairer, Norsett, Wanner, Solving Ordinary Differential Equations I,
// III.1), with the weight (t + h - s) of a position in place of a velocity's 1.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "server/dynamics/impulse/joints/joint.h"

namespace visum::dynamics::impulse {

// That a joint gives to its child, about its point P, in W; the opposite is the parent's.
struct JointImpulse {
  Vector3d w = Vector3d::Zero(), v = Vector3d::Zero();
};

class Prediction {
 public:
  explicit Prediction(std::size_t joints = 0);
  bool empty() const { return line_.empty(); }

  // A step of length h starts (again).
  void begin(double h);
  bool is_ready() const { return ready_; }  // enough is known for at()
  const JointImpulse& at(std::size_t i) const { return foreseen_[i]; }
  std::span<JointImpulse> foreseen() { return foreseen_; }  // to be changed before it is given
  void give_foreseen() { std::copy(foreseen_.begin(), foreseen_.end(), given_.begin()); }  // before all else
  // What the joints give in the step, at its start and at its end: nothing after begin(), to be added to.
  std::span<JointImpulse> ahead() { return std::span(given_).first(line_.size()); }
  std::span<const JointImpulse> ahead() const { return std::span(given_).first(line_.size()); }
  std::span<JointImpulse> after() { return std::span(given_).subspan(line_.size()); }
  void take_back_after() { std::ranges::fill(after(), JointImpulse{}); }  // its end starts again
  // The step is done. forget(): by something that the next step knows nothing of.
  void end();
  void forget() { count_ = 0; }

  // Its part of the world's state, so that a restored world goes on with the same bits.
  std::size_t bytes() const;
  void read(std::span<const std::byte> from);  // bytes(), or others, that count for nothing
  void write(std::span<std::byte> to) const;

 private:
  // Of a step that is done, P and what the line has missed: to single precision, which is checked by the
  // look-ahead as all of it is.
  struct Past {
    std::array<float, 6> given, missed;
  };

  // Of the last step, and of the one before it.
  const Past* last() const { return past_.data() + newest_ * line_.size(); }
  Past* before() { return past_.data() + (1 - newest_) * line_.size(); }
  void clear();

  std::vector<JointImpulse> given_;     // in the step, ahead of all joints, then after
  std::vector<JointImpulse> line_;      // the first part of what is foreseen, of the step that began
  std::vector<JointImpulse> foreseen_;  // all of it
  std::vector<Past> past_;              // of two steps, by joint
  std::array<double, 2> lengths_{};     // of those, s
  std::size_t newest_ = 0, count_ = 0;  // which of the two is the last one, how many steps are known
  double h_ = 0.0;
  bool ready_ = false;
};

}  // namespace visum::dynamics::impulse
