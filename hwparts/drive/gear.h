// The gear between rotor and joint: torsion, backlash, friction, rotor inertia and brake. It is coupled
// implicitly to whatever the joint hangs on, so it is stable at any stiffness, inertia and tick. Pure
// functions over DriveState.
//
// clang-format off
// Symbols (module's coordinate, see drive_data.h; ⁺ marks the tick's end):
//   h      tick
//   θ, ω   rotor's position and speed
//   q, q̇   joint's position and speed
//   φ      torsion, θ - q, less half the backlash when engaged
//   k, d   stiffness and damping of the gear
//   J      reflected rotor inertia, N² J_rotor
//   τ      effort transmitted to the joint
//   τm     motor effort, k_m N I
//   S      secant of friction, S ω = friction effort (friction.h), plus the back-EMF's slope where the supply
//          limits
//
// Rotor, semi-implicitly:
//   J (ω⁺ - ω) = h (τm - S ω⁺ - τ); with Jₑ = J + h S  and the speed without a load  ωf = (J ω + h τm) / Jₑ :
//   ω⁺ = ωf - h τ / Jₑ                                                                                  (1)
// Spring and damper at the tick's end, φ⁺ = φ + h (ω⁺ - q̇⁺):
//   τ = k φ⁺ + d (ω⁺ - q̇⁺) = k φ + κ (ω⁺ - q̇⁺),   κ = h k + d                                          (2)
// (1) in (2), with everything that the drive knows on one side:
//   τ = (v* - q̇⁺) / c,    v* = ωf + k φ / κ,    c = 1/κ + h/Jₑ                                          (3)
// A JointDrive says just this: target_velocity = v*, compliance = c. The engine finds q̇⁺ together with
// contacts and all other joints, and reports τ. Then (1) moves the rotor: θ⁺ = θ + h ω⁺. A rigid gear is
// k -> infinity: c = h/Jₑ, v* = ωf, and the rotor is where the joint is. 1/κ is the CFM by which Hsu and
// Peters give ODE a spring with a damper (Extending Open Dynamics Engine for the DARPA Virtual Robotics
// Challenge, SIMPAR 2014); h/Jₑ is the rotor's part.
//
// This is backward Euler, whose error is of first order in h. Where the engine moves the joint by the mean
// of q̇ and q̇⁺, which is of second order, so is the gear: the rotor moves by the mean of ω and ω⁺, friction
// is found at the place α within the tick (0 to 1), the damper at ϑ, and the spring after σh. With
// ω_α = (1-α) ω + α ω⁺, and others alike:
//   J (ω⁺ - ω) = h (τm - S ω_α - τ):   Jₑ = J + α h S,   ωf = (J ω + h τm - (1-α) h S ω) / Jₑ  in (1)
//   τ = k φ + κ (ω_ϑ - q̇_ϑ),   κ = σ h k + d:
//   v* = ωf + (k φ + (1-ϑ) κ (ω - q̇)) / ϑκ,   c = 1/ϑκ + h/Jₑ                                         (4)
// Places of 1/2 would make the midpoint rule, in which what is too fast for the tick goes on for ever. With
// I the link's own inertia on the axis, and 1/m = 1/J + 1/I,
//   α = 1/2 + f(h S/J),   ϑ = 1/2 + f(h d/m),   σ = 1/2 + f(h d/m + h sqrt(k/m)),   f(x) = x/(12 + 2x)  (5)
// are of second order still, and damp it as far as there is a damper. The slope 1/12 is that of the θ method
// which is exact for a decay at the rate x/h (exponential fitting: Liniger, Willoughby, SIAM J. Numer.
// Anal. 7, 1970). S is taken at the speed that is expected at αh with τ of the tick before.
//   A tick that starts within the backlash, or may leave a flank, has σ = 1. Without a damper and friction
// the energy E of rotor, spring and joint never grows so: ϑ = 1/2, τ does the spring's work at its place
// over φ⁺ - φ, and the spring's potential is convex. With them E + h/2 ((ϑ-1/2) κ (ω-q̇)² + (α-1/2) S ω²)
// does not grow while the places stay; E itself may rise in a tick that is too long for a light link.
//   A hit within the tick changes q̇ before the gear acts, so that (4) is off by (1-ϑ) κ times that change,
// for one tick.
//   Dry friction or a closed brake, whose law is about the tick's end, leaves the tick at backward Euler.
// clang-format on
//
// Backlash b: within |θ - q| <= b/2 the gear transmits nothing. The flank that the motion runs towards is a
// spring that can push but not pull. With side s: φ = θ - q - s b/2, and s τ in [0, F], where F is the
// breaking effort. A JointDrive's limits are symmetric, so half of F goes into the feedforward:
// max_effort = F/2, feedforward = s F/2, and v* less c s F/2 gives the same τ as (3) wherever 0 < s τ < F.
// q̇⁺ itself decides, within the tick, whether the flank is entered or left. Since the flank's potential is
// convex, an implicit step through it never gains energy.
//
// Dry friction acts on the rotor as Coulomb has it: T while it slides, up to Tₛ >= T while it sticks. A
// closed brake is dry friction, too, and adds its holding effort to both; τm is then 0 unless the brake is
// stuck. The momentum that moves the rotor is p = J ω + h (τm - τ), with τ of the tick before.
//   |p| <= h T (h Tₛ at rest)   The rotor sticks: ω⁺ = 0, so c = 1/κ and v* = k φ / κ. Should
//                               |J ω / h + τm - τ| turn out above Tₛ, it starts to slide.
//   otherwise                   It slides, and T acts against p: ωf = (J ω + h (τm - T sign p)) / Jₑ. It
//                               sticks again where (1) would turn it around.
// With a rigid gear the joint sticks with the rotor: v* = c = 0, the limit is Tₛ, and J ω / h + τm is the
// feedforward.
//
// A gear that slips above F (a fault) carries no more than F, and gives way where its torsion would need
// more. The rotor is then set back by whole increments, which zero_offset takes up, so that the encoder does
// not see it.
//
// n joints on one drive (q = Σ qᵢ, a gripper's fingers): each joint gets a share of 1/n in k, d, J and F, and
// its own torsion θ - n qᵢ. Effort and speed at the joint are n and 1/n times the module's. (1) sums the
// shares, which can only lose energy compared with n rotors of their own. For equal fingers it is exact.
#pragma once

#include <span>

#include "hwparts/drive/drive_data.h"
#include "hwparts/drive/drive_state.h"
#include "hwparts/joint.h"

namespace visum::drive {

// The motor during a tick: its effort at the rotor's present speed, and how the effort falls with speed.
struct MotorEffort {
  double effort = 0.0;   // [F]
  double damping = 0.0;  // [F]/([u]/s), >= 0
};

// The joints that hang on the gear.
struct Load {
  bool moves_by_mean_speed = false;  // hwparts::JointInfo, of all joints
  double inertia = 0.0;              // kg·m² or kg: I, in the module's coordinate; 0: not known
};

// The rotor during one tick, as (1) has it.
struct RotorPlan {
  double free_speed = 0.0;     // ωf
  double mobility = 0.0;       // h/Jₑ; 0: it sticks
  bool by_mean_speed = false;  // it moves so, and the gear is of second order
  // The rest is for a rotor with dry friction.
  bool dry = false;
  double sliding = 0.0;         // -1 or +1, the direction in which it slides; 0: it sticks
  double slide_mobility = 0.0;  // h/Jₑ should it start to slide
  double friction = 0.0;        // [F], T
  double breakaway = 0.0;       // [F], Tₛ
  double push = 0.0;            // [F], J ω / h + τm, against which it sticks
};

// The places within the tick, by (5), at which the gear acts on a flank that it does not leave.
struct GearPlaces {
  double damper = 1.0;  // ϑ
  double spring = 1.0;  // σ
};
GearPlaces places_of(const DriveData& data, const Load& load, double tick_s);

// Before the step: how the rotor will move, given the effort that the joints turn out to feel.
RotorPlan plan_rotor(const DriveData& data, const DriveState& state, const MotorEffort& motor, bool braked,
                     bool joints_move_by_mean_speed, double tick_s);

// The drive of one joint, of the `share` joints that hang on the gear. The gear carries at most `most_effort`
// [F].
hwparts::JointDrive couple(const DriveData& data, const RotorPlan& plan, const DriveState& state,
                           const GearPlaces& places, double most_effort, std::size_t share,
                           const hwparts::JointSample& joint, double tick_s);

// After the step: moves the rotor by the effort that the joints felt. `joints` as the engine left them.
void move_rotor(const DriveData& data, const RotorPlan& plan, std::span<const hwparts::JointSample> joints,
                double tick_s, DriveState& state);

// After move_rotor(): lets the gear give way where its torsion needs more than `slip_effort` [F]. Infinite:
// it does not slip.
void slip_gear(const DriveData& data, std::span<const hwparts::JointSample> joints, double slip_effort,
               DriveState& state);

}  // namespace visum::drive
