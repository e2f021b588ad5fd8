// The prediction of what joints will have to give in a step, from what they gave in the last steps.
// The rest that must be solved for is then small, or zero.
//
// Symbols: F a joint's reaction; h the step's length; lambda the impulse at the start of the step, which
// closes the gap at its end; P all that the joint gives in a step, at start and end together; index 1 the
// last step, 2 the one before it.
//   P_1 = integral of F over step 1,  lambda = 1/h integral of (t + h - s) F(s) ds + h^2 K
// The integral comes from the line through the means P_1/h_1 and P_2/h_2; for steps of one length it is 11/12
// P_1
// - 5/12 P_2. K is smooth: it stems from levers and inertias that turn within a step, and from F's curvature.
// It is what the line has missed in the last two steps, carried on as a line. The steps of a composition
// differ in length and direction; the same formulas hold. The sums P are kept, not lambda alone: a gap that
// was closed one step late kicks both ends of a step, once forwards and once back.
// Source: Adams' way to integrate (Hairer, Norsett, Wanner, Solving Ordinary Differential Equations I,
// III.1), with the weight (t + h - s) of a position where a velocity has 1.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "server/dynamics/impulse/joints/joint.h"

namespace visum::dynamics::impulse {

// The impulse that a joint gives to its child, about its point P, in W: N·m·s and N·s. The parent gets the
// opposite.
struct JointImpulse {
  Vector3d w = Vector3d::Zero(), v = Vector3d::Zero();
};

// One joint impulse per joint of a mechanism. Order of calls in a step: begin(), then foreseen impulses and
// additions, then end() or forget(). Each Mechanism owns one. Nothing fails: bytes of another
// engine count as "nothing known".
class Prediction {
 public:
  explicit Prediction(std::size_t joints = 0);
  // True where the mechanism does not predict.
  bool empty() const { return line_.empty(); }

  // Starts a step of length h, or starts it again.
  void begin(double h);
  bool is_ready() const { return ready_; }  // whether enough is known for at()
  const JointImpulse& at(std::size_t i) const { return foreseen_[i]; }
  std::span<JointImpulse> foreseen() { return foreseen_; }  // may be changed before it is given
  // To be called before anything else is added.
  void give_foreseen() { std::copy(foreseen_.begin(), foreseen_.end(), given_.begin()); }
  // The impulses of the joints in this step, at its start and at its end. Zero after begin(); the solver adds
  // to it.
  std::span<JointImpulse> ahead() { return std::span(given_).first(line_.size()); }
  std::span<const JointImpulse> ahead() const { return std::span(given_).first(line_.size()); }
  std::span<JointImpulse> after() { return std::span(given_).subspan(line_.size()); }
  void take_back_after() {
    std::ranges::fill(after(), JointImpulse{});
  }  // the end of the step is solved again
  // The step is done. forget(): it is done, but something acted that the next step cannot foresee.
  void end();
  void forget() { count_ = 0; }

  // Its part of the world's state: a restored world goes on with the same bits.
  std::size_t bytes() const;
  void read(std::span<const std::byte> from);  // anything but bytes() of its own counts as nothing known
  void write(std::span<std::byte> to) const;

 private:
  // The record of a step: P, and what the line has missed. Single precision is enough, since the look-ahead
  // checks every foreseen impulse.
  struct Past {
    std::array<float, 6> given, missed;
  };

  // The last step, and the one before it.
  const Past* last() const { return past_.data() + newest_ * line_.size(); }
  Past* before() { return past_.data() + (1 - newest_) * line_.size(); }
  // As before the first step.
  void clear();

  std::vector<JointImpulse> given_;     // in this step: `ahead` of all joints, then `after`
  std::vector<JointImpulse> line_;      // first part of the foreseen impulses: the integral
  std::vector<JointImpulse> foreseen_;  // the whole
  std::vector<Past> past_;              // two steps, by joint
  std::array<double, 2> lengths_{};     // of these, s
  std::size_t newest_ = 0,
              count_ = 0;  // newest_: which of the two is the last step; count_: how many are known
  double h_ = 0.0;         // s, of the step that has begun
  bool ready_ = false;
};

}  // namespace visum::dynamics::impulse
