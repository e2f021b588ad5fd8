#include "clients/examples/pick_and_place/run.h"

#include <cstdarg>
#include <cstdio>

namespace visum::pick_and_place {
namespace {

constexpr double kCarefulShare = 0.4;  // of the speed, near the box and the table
constexpr int kSettleTicks = 20;       // after a motion, until the drives have settled

class Worker {
 public:
  Worker(Arm& arm, const ArmModel& model, const MotionLimits& limits)
      : arm_(arm), gripper_(arm, model.fingers[0].upper), limits_(limits), careful_(limits) {
    careful_.speed *= kCarefulShare;
  }

  void open(double width) { gripper_.open_for(width); }

  void grasp(double width) {
    if (!gripper_.close_on(width)) throw LostBox("the gripper closed on nothing: no box is there");
    holding_ = true;
  }

  void let_go(double width) {
    holding_ = false;
    gripper_.open_for(width);
  }

  void move(const Way& way) {
    for (const JointPath& leg : way) follow(leg, limits_);
  }
  void move_carefully(const JointPath& path) { follow(path, careful_); }

  [[gnu::format(printf, 2, 3)]] void say(const char* format, ...) const {
    std::printf("%7.2f s  ", arm_.time_s());
    va_list arguments;
    va_start(arguments, format);
    std::vprintf(format, arguments);
    va_end(arguments);
    std::printf("\n");
    std::fflush(stdout);
  }

 private:
  void follow(const JointPath& path, const MotionLimits& limits) {
    const Trajectory trajectory(path, limits);
    const double period_s = 1e-3 * kPeriod_ms;
    const auto periods = int(trajectory.duration_s() / period_s) + 1;
    for (int i = 1; i <= periods + kSettleTicks; ++i) {
      arm_.command(trajectory.at(i * period_s));
      arm_.tick();
      if (holding_ && !gripper_.holds()) throw LostBox("the box slipped out of the gripper");
    }
  }

  Arm& arm_;
  Gripper gripper_;
  MotionLimits limits_, careful_;
  bool holding_ = false;
};

}  // namespace

void run(Arm& arm, const ArmModel& model, const Plan& plan, const Job& job, const MotionLimits& limits) {
  constexpr double kDegrees = 57.29577951308232;
  Worker worker(arm, model, limits);
  worker.say("opens the gripper");
  worker.open(job.width);
  worker.say("moves above the box at (%.3f, %.3f), the gripper pointing down by %.0f degrees", job.from.x(),
             job.from.y(), kDegrees * plan.tilt);
  worker.move(plan.to_box);
  worker.say("goes down to it");
  worker.move_carefully(plan.to_grasp);
  worker.say("closes the gripper");
  worker.grasp(job.width);
  worker.say("holds the box; lifts it by %.0f mm", 1e3 * job.lift);
  worker.move_carefully(plan.lift);
  worker.say("carries it above (%.3f, %.3f)", job.to.x(), job.to.y());
  worker.move(plan.carry);
  worker.say("puts the box down at (%.3f, %.3f)", job.to.x(), job.to.y());
  worker.move_carefully(plan.put_down);
  worker.say("opens the gripper");
  worker.let_go(job.width);
  worker.say("draws back");
  worker.move_carefully(plan.retreat);
  worker.say("goes home");
  worker.move(plan.home);
  worker.say("done: carried the box from (%.3f, %.3f) to (%.3f, %.3f); largest following error %.4f rad",
             job.from.x(), job.from.y(), job.to.x(), job.to.y(), arm.largest_following_error());
}

}  // namespace visum::pick_and_place
