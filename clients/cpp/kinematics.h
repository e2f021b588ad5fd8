// Kinematics of an arm: where its tool is for given joint values, and the joint values that bring it to a
// pose.
//
//   visum::Chain chain = client.chain("arm/link_7");            // from visum.h
//   visum::Pose goal = chain.forward(values);
//   goal.position[2] += 0.05;
//   visum::InverseSolution found = chain.inverse(goal, values);
//   if (found.reached) desired.set(found.values);
//
// Lengths are in metres, angles in radians. Poses are those of the tool's link frame in the frame of the body
// that carries the chain. Without state and without the server: any thread may use a Chain. A vector of the
// wrong length throws Error(kMisuse).
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace visum {

struct Pose {
  std::array<double, 3> position{0.0, 0.0, 0.0};
  std::array<double, 4> orientation{1.0, 0.0, 0.0, 0.0};  // w x y z, of length 1
};

struct ChainJoint {
  std::string name;                 // as in the scene
  std::string part;                 // the part that drives it
  bool slides = false;              // else it turns
  Pose frame;                       // of the joint, in the link before it
  std::array<double, 3> axis{};     // of length 1, in the joint's frame
  double lower = 0.0, upper = 0.0;  // infinite: no limit
  Pose child;                       // of the link behind it, in the moved joint's frame
};

struct InverseOptions {
  double tolerance = 1e-6;  // m, and rad: an error below it counts as reached
  int iterations = 60;      // at most so many from each start
  // How many starts are tried until the pose is reached. 1: only the given one, and so the solution next to
  // it. The others are spread over the joints' ranges, and are always the same.
  int starts = 400;
};

struct InverseSolution {
  std::vector<double> values;  // the best that was found; always within the limits
  bool reached = false;
  double position_error = 0.0;  // m
  double rotation_error = 0.0;  // rad
};

class Chain {
 public:
  // From `base`, a body's name (empty: the world), to the tool.
  Chain(std::string base, std::vector<ChainJoint> joints);

  const std::string& base() const { return base_; }
  const std::vector<ChainJoint>& joints() const { return joints_; }
  std::size_t size() const { return joints_.size(); }

  Pose forward(std::span<const double> values) const;
  // Damped least squares (Levenberg and Marquardt), within the limits.
  InverseSolution inverse(const Pose& tool, std::span<const double> start,
                          const InverseOptions& options = {}) const;

 private:
  InverseSolution descend(const Pose& tool, std::vector<double> values, const InverseOptions& options) const;
  InverseSolution judge(const Pose& tool, std::vector<double> values, double tolerance) const;
  std::vector<double> step(const Pose& tool, std::span<const double> values, double damping) const;
  std::vector<double> clamped(std::span<const double> values) const;
  std::vector<double> spread(int number) const;

  std::string base_;
  std::vector<ChainJoint> joints_;
};

// `inner` is given in the frame of `outer`.
Pose compose(const Pose& outer, const Pose& inner);
Pose inverse_of(const Pose& pose);

}  // namespace visum
