// visum-pick-and-place: an example controller. It reads the arm's URDF, plans the whole job, and commands the
// arm through its ports every 10 ms. It knows nothing of the world except its command line.
#include <csignal>
#include <cstdio>
#include <exception>

#include "clients/cpp/visum.h"
#include "clients/examples/pick_and_place/options.h"
#include "clients/examples/pick_and_place/run.h"

namespace {

using namespace visum::pick_and_place;

constexpr int kDone = 0, kFailed = 1, kConnectionLost = 4, kInterrupted = 130;

volatile std::sig_atomic_t stop_asked = 0;

// The first signal ends the motion in good order; a second one ends the program at once.
void listen_to_signals() {
  struct sigaction action {};
  action.sa_handler = [](int) { stop_asked = 1; };
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

// Leaves the drives some acceleration to catch up with.
MotionLimits motion_limits(const Arm& arm, const Options& options) {
  return {options.speed * arm.maximum_speeds(),
          (0.9 * arm.ramp_accelerations()).cwiseMin(options.acceleration)};
}

int say_why(const std::exception& error, int exit_code) {
  std::fprintf(stderr, "visum-pick-and-place: %s\n", error.what());
  return exit_code;
}

int work(const Options& options) {
  const ArmModel model = read_arm(options.urdf);
  visum::Client client(options.connect, {.name = "visum-pick-and-place", .token_file = options.token_file});
  Arm arm(client, options.part, model.chain.joints.size(), model.fingers.size(), stop_asked);
  try {
    const Plan plan = make_plan(model, arm.angles(), options.job);
    run(arm, model, plan, options.job, motion_limits(arm, options));
  } catch (const Unreachable& error) {
    arm.release();
    return say_why(error, kFailed);
  } catch (const LostBox& error) {
    arm.hold_and_release();
    return say_why(error, kFailed);
  } catch (const Interrupted& error) {
    arm.hold_and_release();
    return say_why(error, kInterrupted);
  }
  arm.release();
  return kDone;
}

}  // namespace

int main(int argc, char** argv) {
  const ParsedOptions parsed = parse_options(argc, argv);
  if (parsed.exit_code >= 0) return parsed.exit_code;
  listen_to_signals();
  try {
    return work(parsed.options);
  } catch (const visum::Error& error) {
    const bool lost =
        error.code() == visum::ErrorCode::kConnection || error.code() == visum::ErrorCode::kTimeout;
    return say_why(error, lost ? kConnectionLost : kFailed);
  } catch (const std::exception& error) {
    return say_why(error, kFailed);
  }
}
