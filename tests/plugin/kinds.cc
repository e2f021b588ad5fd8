// A plug-in for tests: an agent, a sensor and a part that do what they should, and others that do not.
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <thread>

#include "protocol/plugin/plugin.h"

namespace {

using namespace visum::plugin;

// Turns a drive by `step` rad per turn, and counts its turns, so that it has a state that matters.
class Stepper final : public Agent {
 public:
  explicit Stepper(AgentContext& scene)
      : step_(scene.settings().number("step", -1.0, 1.0)),
        arm_(scene.commanded("arm")),
        angle_(arm_.input("Desired Angle 1")),
        turns_(scene.add_output({"Desired", "rad", -1e3, 1e3, 0.0})) {}

  void think(const Turn& turn) override {
    desired_ += step_;
    arm_.set(angle_, desired_);
    turn.outputs[turns_] = desired_;
  }
  void reset() override { desired_ = 0.0; }
  void save(StateOut& to) const override { to.put(desired_); }
  void load(StateIn& from) override { from.get(desired_); }

 private:
  const double step_;
  PartLink& arm_;
  std::size_t angle_, turns_;
  double desired_ = 0.0;
};

// Misbehaves as `does` says, from its third turn on.
class Culprit final : public Agent {
 public:
  explicit Culprit(AgentContext& scene) : does_(scene.settings().text("does")), arm_(scene.commanded("arm")) {
    if (does_ == "throws at once") throw Error("no mood today");
  }

  void think(const Turn& turn) override {
    if (++turns_ < 3) return arm_.set(0, 0.5);
    if (does_ == "sleeps" && turns_ == 3) std::this_thread::sleep_for(std::chrono::seconds(3));
    if (does_ == "throws") throw std::runtime_error("lost its head");
    if (does_ == "throws an int") throw 42;
    while (does_ == "hangs") std::this_thread::yield();
    if (does_ == "sets not a number") arm_.set(0, std::numeric_limits<double>::quiet_NaN());
    if (does_ == "sets too much") arm_.set(0, 1e9);
    if (does_ == "sets an unknown port") arm_.set(999, 0.0);
    if (does_ == "asks for an unknown name") arm_.set(arm_.input("Desired Angel 1"), 0.0);
    if (does_ == "reads an unknown port") turn.outputs[0] = arm_.value(999);
  }
  void save(StateOut& to) const override {
    if (does_ == "cannot save") throw Error("has no paper");
    to.put(turns_);
  }
  void load(StateIn& from) override { from.get(turns_); }

 private:
  const std::string does_;
  PartLink& arm_;
  int turns_ = 0;
};

class Watcher final : public Agent {
 public:
  explicit Watcher(AgentContext& scene) : arm_(scene.watched("arm")) {}
  void think(const Turn&) override { arm_.set(0, 0.1); }

 private:
  PartLink& arm_;
};

// Adds up all bytes of the pictures that it sees.
class Onlooker final : public Agent {
 public:
  explicit Onlooker(AgentContext& scene)
      : eye_(scene.watched("eye")), sum_(scene.add_output({"Sum", "", 0.0, 1e15, 0.0})) {}
  void think(const Turn& turn) override {
    for (const std::byte byte : eye_.blackboard("image")) seen_ += std::to_integer<unsigned>(byte);
    turn.outputs[sum_] = static_cast<double>(seen_);
  }
  void reset() override { seen_ = 0; }
  void save(StateOut& to) const override { to.put(seen_); }
  void load(StateIn& from) override { from.get(seen_); }

 private:
  PartLink& eye_;
  std::size_t sum_;
  std::uint64_t seen_ = 0;
};

// The angle between its z axis and the world's, rad.
class Tilt final : public Sensor {
 public:
  explicit Tilt(SensorContext& scene)
      : throws_(scene.settings().flag_or("throws", false)), nan_(scene.settings().flag_or("nan", false)) {
    scene.add_output({"Tilt", "rad", 0.0, 3.2, 0.0});
  }
  void measure(const Truth& truth, std::span<double> numbers) const override {
    if (throws_ && truth.time_ns() > 5'000'000) throw Error("the bubble has burst");
    const Pose pose = truth.pose();
    const double x = pose.q_wxyz[1], y = pose.q_wxyz[2];
    numbers[0] = std::acos(1.0 - 2.0 * (x * x + y * y));
    if (nan_ && truth.time_ns() > 5'000'000) numbers[0] = std::nan("");
  }

 private:
  const bool throws_, nan_;
};

// The distance straight down, to test rays.
class Height final : public Sensor {
 public:
  explicit Height(SensorContext& scene) {
    scene.add_output({"Height", "m", 0.0, 10.0, 0.0});
    if (scene.settings().flag_or("rays", true)) scene.wants_rays();
  }
  void measure(const Truth& truth, std::span<double> numbers) const override {
    constexpr double kDown[] = {0.0, 0.0, -1.0};
    numbers[0] = truth.distance(kDown, 10.0);
  }
};

// Applies a torque to each of its joints.
class Motor final : public Part {
 public:
  explicit Motor(PartContext& scene)
      : fails_(scene.settings().text_or("fails", "")), torques_(scene.joints().size()) {
    for (const Joint& joint : scene.joints()) {
      scene.add_input({"Torque " + joint.name, "Nm", -10.0, 10.0, 0.0, "Torque"});
      scene.add_output({"Angle " + joint.name, "rad", -1e6, 1e6, 0.0, "Angle"});
    }
  }
  void act(std::span<const double> inputs, std::span<const JointSample>,
           std::span<JointDrive> drives) override {
    for (std::size_t i = 0; i < drives.size(); ++i) drives[i].feedforward = inputs[i];
    if (fails_ == "act" && inputs[0] > 5.0) drives[0].feedforward = std::nan("");
  }
  void publish(std::span<const JointSample> joints, std::span<double> outputs) override {
    for (std::size_t i = 0; i < joints.size(); ++i) outputs[i] = joints[i].position;
    if (fails_ == "publish") outputs[0] = 1e9;
  }

 private:
  const std::string fails_;
  std::vector<double> torques_;
};

// Misbehaves as `does` says, from its third step on. Before that it moves its bodies and counts the steps.
class Clumsy final : public Engine {
 public:
  explicit Clumsy(EngineContext& scene) : does_(scene.settings().text_or("does", "")) {
    if (does_ == "throws at once") throw Error("has no arms");
    if (does_ == "wants two bodies" && scene.bodies().size() != 2) throw Error("has two hands");
  }

  void step(const EngineTick& tick) override {
    Motion& first = tick.bodies[0];
    first.p[0] += 1e-3 * ++steps_;
    if (steps_ < 3) return;
    if (does_ == "throws") throw std::runtime_error("slipped");
    if (does_ == "leaves not a number") first.velocity[1] = std::nan("");
    if (does_ == "leaves no rotation") first.q_wxyz[0] = 0.5;
    if (does_ == "loses a body") first.p[2] = 1e9;
    if (does_ == "tells of endless effort") tick.efforts[0] = std::numeric_limits<double>::infinity();
    if (does_ == "moves what is not its own")
      for (Motion& body : tick.bodies.subspan(1)) body.p[2] += 1.0;
  }
  void reset() override { steps_ = 0; }
  void save(StateOut& to) const override { to.put(steps_); }
  void load(StateIn& from) override { from.get(steps_); }

 private:
  const std::string does_;
  int steps_ = 0;
};

constexpr EngineKind kEngines[] = {{"clumsy", "moves the first body, badly", make_engine<Clumsy>}};
constexpr AgentKind kAgents[] = {{"stepper", "turns a drive on", make_agent<Stepper>},
                                 {"culprit", "does what it should not", make_agent<Culprit>},
                                 {"watcher", "writes where it may only read", make_agent<Watcher>},
                                 {"onlooker", "adds up what it sees", make_agent<Onlooker>}};
constexpr SensorKind kSensors[] = {{"tilt", "how far from upright", make_sensor<Tilt>},
                                   {"height", "above what is below", make_sensor<Height>}};
constexpr PartKind kParts[] = {{"motor", "torques", make_part<Motor>}};

}  // namespace

VISUM_PLUGIN({.name = "kinds",
              .version = "1.0",
              .agents = kAgents,
              .sensors = kSensors,
              .parts = kParts,
              .engines = kEngines})
