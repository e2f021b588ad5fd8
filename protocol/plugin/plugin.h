// The interface for plug-ins; this header is all that a plug-in is built against. A plug-in is a shared
// library that adds kinds of agents, sensors, hardware parts and engines to scenes. It lists them in one
// function (VISUM_PLUGIN, below) and links nothing of Visum.
//
//   class Blinker : public visum::plugin::Agent {
//    public:
//     explicit Blinker(visum::plugin::AgentContext& scene)
//         : lamp_(scene.commanded("lamp")), light_(lamp_.input("Light")) {}
//     void think(const visum::plugin::Turn& turn) override {
//       lamp_.set(light_, turn.time_ns / 500'000'000 % 2);
//     }
//
//    private:
//     visum::plugin::PartLink& lamp_;
//     std::size_t light_;
//   };
//   constexpr visum::plugin::AgentKind kAgents[] = {{"blinker", "a lamp that blinks",
//                                                    visum::plugin::make_agent<Blinker>}};
//   VISUM_PLUGIN({.name = "blinker", .version = "1.0", .agents = kAgents})
//
// Threads: everything is called on one thread.
//
// Errors: constructors may throw. The scene is then wrong, and the exception's text says why. A node that
// throws later is at fault, with the exception's text as the reason, and the world goes on without it. Only
// an engine cannot be spared: if it throws, the world freezes.
//
// State: everything that changes must go through save() and load(), so that a world that is restored goes on
// with the same bits. Own clocks and own random numbers break that.
//
// Time: nothing may wait, because the tick waits with it. If a call has not come back after a second, the
// log, `visum status` and /healthz name it. After 10 s (visumd --node-timeout) visumd ends with exit code
// 124: a thread that is stuck in a library cannot be recovered, and the world cannot go on without its node.
//
// Units: SI, radians, right-handed frames with z up, quaternions as w x y z.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace visum::plugin {

// Grows with every change of this header that breaks plug-ins built before.
inline constexpr std::uint32_t kAbi = 3;
// Names the C++ library, because both sides must mean the same by std::string and std::vector.
#if defined(_GLIBCXX_USE_CXX11_ABI) && _GLIBCXX_USE_CXX11_ABI
inline constexpr const char* kRuntime = "libstdc++";
#elif defined(__GLIBCXX__)
inline constexpr const char* kRuntime = "libstdc++ with old strings";
#else
inline constexpr const char* kRuntime = "another C++ library";
#endif

// The reason why something is impossible. Any other std::exception serves as well.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// ---------------------------------------- State

// Writes a node's state: numbers, truth values and enums, one after the other.
class StateOut {
 public:
  explicit StateOut(std::vector<std::byte>& bytes) : bytes_(bytes) {}

  template <typename T>
  void put(const T& value) {
    put(std::span<const T>(&value, 1));
  }
  template <typename T>
  void put(std::span<const T> values) {
    static_assert(std::is_arithmetic_v<T> || std::is_enum_v<T>);
    const auto bytes = std::as_bytes(values);
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
  }

 private:
  std::vector<std::byte>& bytes_;
};

// Reads a node's state in the order in which it was written. Throws Error if the bytes end early.
class StateIn {
 public:
  explicit StateIn(std::span<const std::byte> bytes) : bytes_(bytes) {}

  template <typename T>
  void get(T& value) {
    get(std::span<T>(&value, 1));
  }
  template <typename T>
  void get(std::span<T> values) {
    static_assert(std::is_arithmetic_v<T> || std::is_enum_v<T>);
    if (values.size_bytes() > bytes_.size())
      throw Error("the saved state is shorter than what is read of it");
    if (!values.empty()) std::memcpy(values.data(), bytes_.data(), values.size_bytes());
    bytes_ = bytes_.subspan(values.size_bytes());
  }
  bool at_end() const { return bytes_.empty(); }

 private:
  std::span<const std::byte> bytes_;
};

// An agent, a part or an engine. Visum owns it.
class Node {
 public:
  virtual ~Node() = default;
  // Back to the state after construction. Called when the world is reset.
  virtual void reset() {}
  // Write and read everything that changes. Called between ticks, for snapshots and for the state's hash.
  virtual void save(StateOut&) const {}
  virtual void load(StateIn&) {}
};

// ---------------------------------------- Making a node

// The node's own keys in the scene. A key that is missing or wrong ends the reading of the scene there, with
// file and line, by an exception. A key that the node never asks for is refused as unknown.
class Settings {
 public:
  // Bounds are inclusive.
  virtual double number(std::string_view key, double lowest, double highest) = 0;
  virtual double number_or(std::string_view key, double otherwise, double lowest, double highest) = 0;
  virtual std::string text(std::string_view key) = 0;
  virtual std::string text_or(std::string_view key, std::string_view otherwise) = 0;
  virtual bool flag_or(std::string_view key, bool otherwise) = 0;
  // For values that are wrong in another way than by their range.
  [[noreturn]] virtual void fail(std::string_view key, const std::string& why) = 0;

 protected:
  ~Settings() = default;
};

// A number that a part or an agent offers. Its index is the order in which it was added.
struct Port {
  std::string name;  // "Desired Angle 1"
  std::string unit;  // "rad"; empty for counts and truth values
  double minimum = 0.0;
  double maximum = 1.0;
  double initial = 0.0;
  std::string group;  // shared by ports that belong together, "Desired Angle"; clients find them by it
};

// ---------------------------------------- Agents

// One part as an agent sees it. The part may be virtual or real, in the same process or on another machine.
class PartLink {
 public:
  // Find ports by name. Throw Error that names the nearest port if there is none.
  virtual std::size_t input(std::string_view name) const = 0;
  virtual std::size_t output(std::string_view name) const = 0;
  virtual Port input_port(std::size_t input) const = 0;
  virtual Port output_port(std::size_t output) const = 0;

  virtual double value(std::size_t output) const = 0;   // as of the end of the last tick
  virtual double command(std::size_t input) const = 0;  // in force, or set in this turn
  // Takes effect at the end of this turn. Throws Error if the part is only watched, if there is no such
  // input, or if the value is not a number in the port's range.
  virtual void set(std::size_t input, double value) = 0;
  // A block of bytes beside the ports, "scan". Valid until the next call. Throws Error if there is none.
  virtual std::span<const std::byte> blackboard(std::string_view name) = 0;

 protected:
  ~PartLink() = default;
};

// Given to an agent's constructor. Its PartLinks outlive the agent.
class AgentContext {
 public:
  virtual const std::string& name() const = 0;  // in the scene
  virtual double period_s() const = 0;          // between two turns
  virtual Settings& settings() = 0;
  // The part that the scene assigns to this word (`parts: {wheels: cart}`). A commanded part belongs to this
  // agent alone.
  virtual PartLink& commanded(std::string_view word) = 0;
  virtual PartLink& watched(std::string_view word) = 0;
  // Adds a sensor output of the agent itself, which everyone can read. Returns its index in Turn::outputs.
  virtual std::size_t add_output(const Port& port) = 0;

 protected:
  ~AgentContext() = default;
};

struct Turn {
  std::int64_t time_ns;       // simulated, since the last reset
  std::span<double> outputs;  // the agent's own, with the values of the last turn
};

// A controller that runs inside the world.
class Agent : public Node {
 public:
  virtual void think(const Turn& turn) = 0;  // once per period, before the parts act
};

struct AgentKind {
  const char* name;
  const char* help;
  std::unique_ptr<Agent> (*make)(AgentContext&);
};
template <typename T>
std::unique_ptr<Agent> make_agent(AgentContext& context) {
  return std::make_unique<T>(context);
}

// ---------------------------------------- Sensors

struct Pose {
  double p[3];
  double q_wxyz[4];
};

// The true state of the world at the end of a tick, for a sensor in it. Valid during the call only.
class Truth {
 public:
  virtual std::int64_t time_ns() const = 0;
  virtual double tick_s() const = 0;
  virtual Pose pose() const = 0;  // of the sensor's frame, in the world
  // Velocity of the sensor's frame, in the world's axes, m/s and rad/s.
  virtual void velocity(double linear[3], double angular[3]) const = 0;
  // Distance in m along a direction (of any length but 0) from the sensor's origin, both in the sensor's
  // frame. Infinity if nothing is within `farthest` m. The body that carries the sensor is not seen.
  virtual double distance(const double direction[3], double farthest) const = 0;
  virtual double normal_force_n() const = 0;  // sum over all that touches the body that carries the sensor
  // Pose of another body or link, "table" or "arm/link_3". False: there is none of that name.
  virtual bool pose_of(std::string_view body, Pose& pose) const = 0;

 protected:
  ~Truth() = default;
};

// Given to a sensor's constructor.
class SensorContext {
 public:
  virtual const std::string& name() const = 0;
  virtual Settings& settings() = 0;
  // Adds a number that the sensor measures; at least one. Visum adds noise, steps, latency, range and
  // failures as the scene says (`noise`, `resolution`, ... in the port's unit). Returns its index in
  // measure()'s `numbers`.
  virtual std::size_t add_output(const Port& port) = 0;
  // Must be called if measure() calls Truth::distance(), before it does.
  virtual void wants_rays() = 0;

 protected:
  ~SensorContext() = default;
};

// Reports the truth only, and keeps nothing from one sample to the next.
class Sensor {
 public:
  virtual ~Sensor() = default;
  // Fills one number for each output, in the order of add_output().
  virtual void measure(const Truth& truth, std::span<double> numbers) const = 0;
};

struct SensorKind {
  const char* name;
  const char* help;
  std::unique_ptr<Sensor> (*make)(SensorContext&);
};
template <typename T>
std::unique_ptr<Sensor> make_sensor(SensorContext& context) {
  return std::make_unique<T>(context);
}

// ---------------------------------------- Hardware parts

struct Joint {
  std::string name;
  bool prismatic = false;  // then m and N instead of rad and N·m
  double lower = 0.0;      // mechanical stops; lower > upper: none
  double upper = 0.0;
  double initial_position = 0.0;
};

// The state of a joint at the end of the last tick.
struct JointSample {
  double position = 0.0;
  double velocity = 0.0;
  double effort = 0.0;  // transmitted by the drive in the last tick
};

// The action on a joint during the next tick. v is the joint's velocity at the end of that tick:
//     effort = clamp((target_velocity - v) / compliance, -max_effort, +max_effort) + feedforward
struct JointDrive {
  double target_velocity = 0.0;
  double compliance = 0.0;  // >= 0; 0: v equals the target
  double max_effort = 0.0;  // >= 0; 0: the first term is off
  double feedforward = 0.0;
};

// Given to a part's constructor.
class PartContext {
 public:
  virtual const std::string& name() const = 0;
  virtual double tick_s() const = 0;
  virtual Settings& settings() = 0;
  virtual std::span<const Joint> joints()
      const = 0;  // the joints that the scene's entry names; all are driven
  virtual std::size_t add_input(const Port& port) = 0;
  virtual std::size_t add_output(const Port& port) = 0;

 protected:
  ~PartContext() = default;
};

// A hardware part: turns controller inputs into drives, and joint samples into sensor outputs.
class Part : public Node {
 public:
  // Before the step: fills one drive per joint. `inputs` are finite and within their ranges.
  virtual void act(std::span<const double> inputs, std::span<const JointSample> joints,
                   std::span<JointDrive> drives) = 0;
  // After the step: fills the sensor outputs.
  virtual void publish(std::span<const JointSample> joints, std::span<double> outputs) = 0;
  // The controller is gone without releasing the part. Stop what moves.
  virtual void controller_lost() {}
};

struct PartKind {
  const char* name;
  const char* help;
  std::unique_ptr<Part> (*make)(PartContext&);
};
template <typename T>
std::unique_ptr<Part> make_part(PartContext& context) {
  return std::make_unique<T>(context);
}

// ---------------------------------------- Engines

// A body that the engine moves or meets. Here and below, a body's place is the place of its centre of mass,
// with the axes of the body.
struct EngineBody {
  std::string name;
  bool own = false;      // moved by this engine; other bodies are fixed, or another engine moves them
  double mass_kg = 0.0;  // only of its own bodies
  double inertia[9] =
      {};  // kg·m², about the centre of mass, in the body's axes, row by row; only of its own bodies
};

// A joint between two of the engine's own bodies, or between one and the world. If the engine cannot handle
// its kind, a stop, friction or damping, it must refuse: throw Error when it is made.
struct EngineJoint {
  std::string name;
  std::string kind;  // as in scenes: "hinge", "slider", "ball", ...; never "point_on_curve"
  int parent = -1;   // index of a body; -1: the world
  int child = -1;
  Pose in_parent, in_child;  // the joint's frame, seen from each; both coincide at position 0
  double axis[3] = {};       // unit vector in that frame
  double axis2[3] = {};      // universal joint: of the child, unit vector, perpendicular to `axis`
  double pitch_m = 0.0;      // screw: travel along the axis per turn
  double stiffness = 0.0;    // springs: N/m or N·m/rad
  double rest = 0.0;         // springs: length or angle without load
  bool limited = false;
  double lower = 0.0, upper = 0.0;  // mechanical stops
  double stop_restitution = 0.0;
  double friction = 0.0;  // constant, N·m or N; acts only while the drive is all 0
  double damping = 0.0;   // N·m·s/rad or N·s/m; acts only while the drive is all 0, but for springs always
};

// Pose and velocity of a body.
struct Motion {
  double p[3], q_wxyz[4];            // the quaternion has unit length
  double velocity[3], turn_rate[3];  // m/s, rad/s; both in the world's frame
};

// A contact that Visum found at t_k.
struct EngineContact {
  int a = -1, b = -1;  // indices of bodies
  double p[3];         // midway between the surfaces
  double normal[3];    // unit, from b to a
  double depth = 0.0;  // > 0: they overlap
  double friction = 0.0, restitution = 0.0;
  double rolling_friction = 0.0, torsional_friction = 0.0;  // m
  double force_on_a[3] = {};  // to be filled: mean over the tick, N; a moment cannot be reported
};

// An external force on a body.
struct EnginePush {
  int body = -1;
  double force_n[3], torque_nm[3];  // at the centre of mass, during this tick
};

// One step from t_k to t_k+1. All spans have the order of EngineContext.
struct EngineTick {
  double tick_s;
  double gravity[3];
  std::span<const EnginePush> pushes;   // on its own bodies
  std::span<const JointDrive> drives;   // by joint
  std::span<const JointSample> joints;  // where its joints are at t_k
  std::span<EngineContact> contacts;    // those that touch its own bodies
  std::span<Motion>
      bodies;  // at t_k; to be moved to t_k+1. Bodies that are not its own must stay as they are
  std::span<double> efforts;  // to be filled: effort that each joint's drive transmitted
};

// Given to an engine's constructor.
class EngineContext {
 public:
  virtual Settings& settings() = 0;
  virtual double tick_s() const = 0;
  virtual std::span<const EngineBody> bodies() const = 0;  // all of the world
  virtual std::span<const EngineJoint> joints() const = 0;

 protected:
  ~EngineContext() = default;
};

// Moves bodies. Each step starts from the bodies that it is given, so an engine keeps only what it also
// saves. The world freezes at its last good state, with the reason, if step() throws, or if it leaves a
// number that is not finite, a quaternion off unit length or a body beyond 1e6 m. It goes on after a reset or
// a restore.
class Engine : public Node {
 public:
  virtual void step(const EngineTick& tick) = 0;
};

struct EngineKind {
  const char* name;
  const char* help;
  std::unique_ptr<Engine> (*make)(EngineContext&);
};
template <typename T>
std::unique_ptr<Engine> make_engine(EngineContext& context) {
  return std::make_unique<T>(context);
}

// ---------------------------------------- The plug-in itself

// All that a plug-in offers. Built by VISUM_PLUGIN.
struct Manifest {
  // These two come first in every version of this header, so that a wrong version can be recognised.
  std::uint32_t abi = kAbi;
  const char* runtime = kRuntime;
  const char* name = "";
  const char* version = "";
  std::span<const AgentKind> agents = {};
  std::span<const SensorKind> sensors = {};
  std::span<const PartKind> parts = {};
  std::span<const EngineKind> engines = {};
};

inline constexpr const char* kEntryName = "visum_plugin";

}  // namespace visum::plugin

#define VISUM_PLUGIN(...)                                                                          \
  extern "C" __attribute__((visibility("default"))) const visum::plugin::Manifest* visum_plugin(); \
  extern "C" const visum::plugin::Manifest* visum_plugin() {                                       \
    static const visum::plugin::Manifest manifest = __VA_ARGS__;                                   \
    return &manifest;                                                                              \
  }
