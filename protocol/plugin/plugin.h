// What a plug-in of Visum is made against: this header alone. A plug-in is a shared library that adds kinds
// of agents, of sensors, of hardware parts and of engines to scenes. It says what it has in one function
// (VISUM_PLUGIN, below) and links nothing of Visum.
//
//   class Blinker : public visum::plugin::Agent {
//    public:
//     explicit Blinker(visum::plugin::AgentContext& scene)
//         : lamp_(scene.commanded("lamp")), light_(lamp_.input("Light")) {}
//     void think(const visum::plugin::Turn& turn) override { lamp_.set(light_, turn.time_ns / 500'000'000 %
//     2); }
//    private:
//     visum::plugin::PartLink& lamp_;
//     std::size_t light_;
//   };
//   constexpr visum::plugin::AgentKind kAgents[] = {{"blinker", "a lamp that blinks",
//                                                    visum::plugin::make_agent<Blinker>}};
//   VISUM_PLUGIN({.name = "blinker", .version = "1.0", .agents = kAgents})
//
// Everything is called on one thread. Constructors may throw: the scene is then wrong, and the text says why.
// What throws later faults its own node, with the exception's text as the reason, and the world goes on; only
// without an engine it cannot, and freezes. All that changes goes through save() and load(), so that a world
// that is taken back goes on with the same bits; clocks and random numbers of one's own break that.
//
// Nothing may wait: the tick waits with it. A call that has not come back after a second is told of by name,
// in the log, in `visum status` and at /healthz, and after 10 s (visumd --node-timeout) visumd ends with exit
// code 124: a thread that is lost in a library cannot be taken back, and half a world is none.
//
// SI units, radians, right-handed frames with z up, quaternions as w x y z.
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

// Grows with every change of this header that a plug-in built before would not survive.
inline constexpr std::uint32_t kAbi = 2;
// Whose std::string and std::vector these are: both sides must mean the same.
#if defined(_GLIBCXX_USE_CXX11_ABI) && _GLIBCXX_USE_CXX11_ABI
inline constexpr const char* kRuntime = "libstdc++";
#elif defined(__GLIBCXX__)
inline constexpr const char* kRuntime = "libstdc++ with old strings";
#else
inline constexpr const char* kRuntime = "another C++ library";
#endif

// The reason why something cannot be; any other std::exception does as well.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// ---------------------------------------- What a node keeps

// Numbers, truth values and enums, one after the other.
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

// Reads in the order of writing. Throws Error where the bytes end early.
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

class Node {
 public:
  virtual ~Node() = default;
  // Back to what it was after construction.
  virtual void reset() {}
  virtual void save(StateOut&) const {}
  virtual void load(StateIn&) {}
};

// ---------------------------------------- What a node is told when it is made

// The node's own keys in the scene. Whoever asks for a key that is missing or wrong ends the reading of the
// scene there, with file and line. A key that nobody asks for is refused as unknown.
class Settings {
 public:
  virtual double number(std::string_view key, double lowest, double highest) = 0;
  virtual double number_or(std::string_view key, double otherwise, double lowest, double highest) = 0;
  virtual std::string text(std::string_view key) = 0;
  virtual std::string text_or(std::string_view key, std::string_view otherwise) = 0;
  virtual bool flag_or(std::string_view key, bool otherwise) = 0;
  // For what is wrong with a value beyond its range.
  [[noreturn]] virtual void fail(std::string_view key, const std::string& why) = 0;

 protected:
  ~Settings() = default;
};

struct Port {
  std::string name;  // "Desired Angle 1"
  std::string unit;  // "rad"; empty for counts and truth values
  double minimum = 0.0;
  double maximum = 1.0;
  double initial = 0.0;
};

// ---------------------------------------- Agents

// One part, as an agent meets it: virtual or real, in the same process or far away.
class PartLink {
 public:
  // By name; throws Error that names the nearest.
  virtual std::size_t input(std::string_view name) const = 0;
  virtual std::size_t output(std::string_view name) const = 0;
  virtual Port input_port(std::size_t input) const = 0;
  virtual Port output_port(std::size_t output) const = 0;

  virtual double value(std::size_t output) const = 0;   // as of the end of the last tick
  virtual double command(std::size_t input) const = 0;  // in force, or set in this turn
  // From the end of this turn on. Throws Error where the part is not commanded, where there is no such input,
  // and for what is not a number or out of the port's range.
  virtual void set(std::size_t input, double value) = 0;
  // A block of bytes beside the ports, "scan"; valid until the next call. Throws Error where there is none.
  virtual std::span<const std::byte> blackboard(std::string_view name) = 0;

 protected:
  ~PartLink() = default;
};

class AgentContext {
 public:
  virtual const std::string& name() const = 0;  // in the scene
  virtual double period_s() const = 0;          // between two turns
  virtual Settings& settings() = 0;
  // The part that the scene gives for this word (`parts: {wheels: cart}`). One that is commanded belongs to
  // this agent alone.
  virtual PartLink& commanded(std::string_view word) = 0;
  virtual PartLink& watched(std::string_view word) = 0;
  // A sensor output of the agent itself, for all to see. Returns its index in Turn::outputs.
  virtual std::size_t add_output(const Port& port) = 0;

 protected:
  ~AgentContext() = default;
};

struct Turn {
  std::int64_t time_ns;       // simulated, since the last reset
  std::span<double> outputs;  // the agent's own, as the last turn left them
};

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

// The world at the end of a tick, for a sensor that sits in it.
class Truth {
 public:
  virtual std::int64_t time_ns() const = 0;
  virtual double tick_s() const = 0;
  virtual Pose pose() const = 0;  // of the sensor's frame, in the world
  virtual void velocity(double linear[3],
                        double angular[3]) const = 0;  // of the sensor's frame, in the world
  // Along a direction (of any length but 0) from the sensor's origin, both in its frame; infinity where
  // nothing is within `farthest` m. Does not see the body that carries the sensor.
  virtual double distance(const double direction[3], double farthest) const = 0;
  virtual double normal_force_n() const = 0;  // the sum of what touches the body that carries the sensor
  // Of another body or link, "table" or "arm/link_3"; false: there is none.
  virtual bool pose_of(std::string_view body, Pose& pose) const = 0;

 protected:
  ~Truth() = default;
};

class SensorContext {
 public:
  virtual const std::string& name() const = 0;
  virtual Settings& settings() = 0;
  // A number that is read: noise, steps, latency, range and failures are put onto it as the scene says
  // (`noise`, `resolution`, ... in the port's unit). At least one. Returns its index in measure()'s numbers.
  virtual std::size_t add_output(const Port& port) = 0;
  // Before the first call of Truth::distance().
  virtual void wants_rays() = 0;

 protected:
  ~SensorContext() = default;
};

// Only says what is true; it keeps nothing from one sample to the next.
class Sensor {
 public:
  virtual ~Sensor() = default;
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

// What a joint did, at the end of the last tick.
struct JointSample {
  double position = 0.0;
  double velocity = 0.0;
  double effort = 0.0;  // what the drive transmitted in the last tick
};

// What acts on a joint during the next tick, with v its velocity at the end of that tick:
//     effort = clamp((target_velocity - v) / compliance, -max_effort, +max_effort) + feedforward
struct JointDrive {
  double target_velocity = 0.0;
  double compliance = 0.0;  // >= 0; 0: v is the target
  double max_effort = 0.0;  // >= 0; 0: the first term is off
  double feedforward = 0.0;
};

class PartContext {
 public:
  virtual const std::string& name() const = 0;
  virtual double tick_s() const = 0;
  virtual Settings& settings() = 0;
  virtual std::span<const Joint> joints() const = 0;  // those that the scene's entry names; all are driven
  virtual std::size_t add_input(const Port& port) = 0;
  virtual std::size_t add_output(const Port& port) = 0;

 protected:
  ~PartContext() = default;
};

class Part : public Node {
 public:
  // Before the step: one drive per joint. `inputs` are finite and within their ranges.
  virtual void act(std::span<const double> inputs, std::span<const JointSample> joints,
                   std::span<JointDrive> drives) = 0;
  // After it.
  virtual void publish(std::span<const JointSample> joints, std::span<double> outputs) = 0;
  // The controller is gone without releasing the part: stop what moves.
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

// What an engine moves or meets. Here and in all that follows a body's place is that of its centre of mass,
// with the axes of the body.
struct EngineBody {
  std::string name;
  bool own = false;        // this engine moves it; others are scenery, or moved by another engine
  double mass_kg = 0.0;    // of its own bodies
  double inertia[9] = {};  // kg·m², about the centre of mass, in the body's axes, row by row; likewise
};

// A joint between two of its own bodies, or one and the world. A stop, friction or damping that it cannot
// hold is to be refused, like a kind: by an Error when it is made.
struct EngineJoint {
  std::string name;
  std::string kind;  // as in scenes: "hinge", "slider", "ball", ...; never "point_on_curve"
  int parent = -1;   // index of a body; -1: the world
  int child = -1;
  Pose in_parent, in_child;  // the joint's frame, seen from each; both are the same place at position 0
  double axis[3] = {};       // in that frame, unit
  double axis2[3] = {};      // universal: of the child, unit, perpendicular to the other
  double pitch_m = 0.0;      // screw: along the axis per turn
  double stiffness = 0.0;    // springs: N/m or N·m/rad
  double rest = 0.0;         // springs: length or angle without a load
  bool limited = false;
  double lower = 0.0, upper = 0.0;  // mechanical stops
  double stop_restitution = 0.0;
  double friction = 0.0;  // constant, N·m or N; counts where the drive is all 0
  double damping = 0.0;   // N·m·s/rad or N·s/m; likewise, and of springs always
};

struct Motion {
  double p[3], q_wxyz[4];            // the quaternion has unit length
  double velocity[3], turn_rate[3];  // m/s, rad/s; both in the world
};

struct EngineContact {
  int a = -1, b = -1;  // indices of bodies
  double p[3];         // midway between the surfaces
  double normal[3];    // unit, from b to a
  double depth = 0.0;  // > 0: they overlap
  double friction = 0.0, restitution = 0.0;
  double rolling_friction = 0.0, torsional_friction = 0.0;  // m
  double force_on_a[3] = {};  // to be filled: mean over the tick, N; a moment cannot be told
};

struct EnginePush {
  int body = -1;
  double force_n[3], torque_nm[3];  // at the centre of mass, during this tick
};

// One step from t_k to t_k+1. All spans are in the order of EngineContext.
struct EngineTick {
  double tick_s;
  double gravity[3];
  std::span<const EnginePush> pushes;   // on its own bodies
  std::span<const JointDrive> drives;   // by joint
  std::span<const JointSample> joints;  // where its joints are at t_k
  std::span<EngineContact> contacts;    // those that touch its own bodies
  std::span<Motion> bodies;             // at t_k, and to be moved on; what is not its own stays as it is
  std::span<double> efforts;            // to be filled: what each joint's drive transmitted
};

class EngineContext {
 public:
  virtual Settings& settings() = 0;
  virtual double tick_s() const = 0;
  virtual std::span<const EngineBody> bodies() const = 0;  // all of the world
  virtual std::span<const EngineJoint> joints() const = 0;

 protected:
  ~EngineContext() = default;
};

// Keeps nothing that matters but what it saves: each step starts from the bodies that it is given. What it
// throws, and a world that it leaves with a number that is none, a quaternion off unit length or a body
// beyond 1e6 m, freezes the world at its last good state, with the reason, until somebody resets or restores.
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

struct Manifest {
  // These two come first in every version of this header.
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
