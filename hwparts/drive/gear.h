// The gear between rotor and joint: torsion, backlash, friction, rotor inertia and brake. It is coupled
// implicitly to whatever the joint hangs on, so it is stable at any stiffness, inertia and tick. Pure
// functions over DriveState.
//
// clang-format off
// Symbols (module's coordinate, see drive_data.h; ⁺ marks the tick's end):
//   h      tick
//   ϑ, σ   places within the tick, 0 to 1
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
// of q̇ and q̇⁺, which is of second order, so is the gear. It finds speeds at ϑh, and the spring at φ_σ:
//   ω_ϑ = (1-ϑ) ω + ϑ ω⁺,    q̇_ϑ alike,    φ_σ = φ + σ h (ω_ϑ - q̇_ϑ)
// (1) to (3) hold so, with ϑh for h in (1) and Jₑ, and σh in κ. With q̇⁺ in place of q̇_ϑ, (3) is
//   v* = (v*_ϑ - (1-ϑ) q̇) / ϑ,    c = c_ϑ / ϑ,    and then    ω⁺ = ω + (ω_ϑ - ω) / ϑ                     (4)
// The rotor moves by the mean of ω and ω⁺, as the joint does. ϑ = σ = 1/2 would be the midpoint rule, in
// which what is too fast for the tick goes on for ever. With y = h (S + d)/J and x = y + h sqrt(k/J),
//   ϑ = 1/2 + f(y),    σ = 1/2 + f(x),    f(x) = x/(12 + 2x)                                              (5)
// are of second order still, and damp it. The slope 1/12 is that of the θ method which is exact for a decay
// at the rate x/h (exponential fitting: Liniger, Willoughby, SIAM J. Numer. Anal. 7, 1970). S in (1) is taken
// at the speed that is expected at ϑh with τ of the tick before.
//   A tick that starts within the backlash, or may leave a flank, has σ = 1. So the energy of rotor, spring
// and joint never grows: with ϑ = 1/2, τ does the spring's work at φ_σ over φ⁺ - φ, and the spring's
// potential is convex. Dampers lift ϑ above 1/2, and take more than that adds; only with dampers far above
// the critical damping it may rise in a tick, by less than the share ϑ - 1/2 (0.2 % seen).
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

// The rotor during one tick, as (1) has it.
struct RotorPlan {
  double free_speed = 0.0;     // ωf
  double mobility = 0.0;       // ϑh/Jₑ; 0: it sticks
  double place = 1.0;          // ϑ
  double spring_place = 1.0;   // σ
  bool by_mean_speed = false;  // the rotor moves so
  // The rest is for a rotor with dry friction.
  bool dry = false;
  double sliding = 0.0;         // -1 or +1, the direction in which it slides; 0: it sticks
  double slide_mobility = 0.0;  // h/Jₑ should it start to slide
  double friction = 0.0;        // [F], T
  double breakaway = 0.0;       // [F], Tₛ
  double push = 0.0;            // [F], J ω / h + τm, against which it sticks
};

// Before the step: how the rotor will move, given the effort that the joints turn out to feel.
// `moved_by_mean_speed`: so the engine moves them (hwparts::JointInfo).
RotorPlan plan_rotor(const DriveData& data, const DriveState& state, const MotorEffort& motor, bool braked,
                     std::span<const hwparts::JointSample> joints, bool moved_by_mean_speed, double tick_s);

// The drive of one joint, of the `share` joints that hang on the gear. The gear carries at most `most_effort`
// [F].
hwparts::JointDrive couple(const DriveData& data, const RotorPlan& plan, double rotor_position,
                           double most_effort, std::size_t share, const hwparts::JointSample& joint,
                           double tick_s);

// After the step: moves the rotor by the effort that the joints felt. `joints` as the engine left them.
void move_rotor(const DriveData& data, const RotorPlan& plan, std::span<const hwparts::JointSample> joints,
                double tick_s, DriveState& state);

// After move_rotor(): lets the gear give way where its torsion needs more than `slip_effort` [F]. Infinite:
// it does not slip.
void slip_gear(const DriveData& data, std::span<const hwparts::JointSample> joints, double slip_effort,
               DriveState& state);

}  // namespace visum::drive
