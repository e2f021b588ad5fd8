// The parts of a world as its cycle holds them, and how they are made from their plans.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "hwparts/kinds/part_kinds.h"
#include "hwparts/part.h"
#include "hwparts/sensors/sensor.h"
#include "server/cycle/network_model.h"
#include "server/scene/scene.h"

namespace visum::cycle {

// One part bound to its joints, with its inputs and outputs. Lives on the tick's thread; the Simulation owns
// it. All spans are in the part's own order.
//
// A controller input exists in five copies, each with its own reason. In the order of a write's journey:
//
//   1. Gateway::latched_       sessions' thread. All inputs of the part as last accepted, with the writes
//                              that are still under way: the part judges its inputs together (Part::refuse).
//   2. gateway::Input::values  the mailbox. Carries the ports of one write to the tick's thread without a
//                              lock, and waits there for the next tick border.
//   3. controller_inputs       tick's thread. The inputs that act in the next tick. They are what snapshots,
//                              the state's hash and recordings hold; agents of the scene write here too. A
//                              NetworkModel with a fault delays a write between 2 and 3, or loses it.
//   4. DriveState::commanded   tick's thread. The target that the ports command of one drive. Telegrams and
//                              the drive's supervision, which see no ports, note there which target they
//                              override until the ports command another one.
//   5. gateway::Published      handed back to the sessions' thread with the whole published world, so that
//                              reads and samples never touch the tick's thread. After a reset, a restore or
//                              a missed deadline the gateway sets copy 1 to these values.
//
// A write becomes a torque in Part::act(), which reads copy 3, and in the engine's step after it.
struct BoundPart {
  std::shared_ptr<hwparts::Part> part;  // shared with sessions, which may still look at a part that went
  std::vector<world::JointId> joints;
  std::vector<double> controller_inputs;  // in force, see above
  std::vector<double> sensor_outputs;
  std::vector<hwparts::JointSample> samples;
  std::vector<hwparts::JointDrive> drives;
  std::vector<double> following_errors;
  std::string agent;      // name of the scene's agent that commands the part; empty: clients may command it
  bool onlooker = false;  // not part of the world's state: see Simulation::add_onlooker

  // The network between the part and its controllers, clients and agents alike. It is ideal unless a fault
  // acts on it.
  NetworkModel network;
  bool silent = false;  // a fault: the part hears no write and shows no new reading

  // A write leaves its controller at `tick`. It is in force at once where the network is ideal.
  void hear(std::int64_t tick, std::size_t first, std::span<const double> values);
  // Puts values in force that have arrived, from port number `first` on.
  void take(std::size_t first, std::span<const double> values);
  // Takes all writes that arrive until this tick.
  void deliver(std::int64_t until_tick);
  // The numbers that publish() is to fill: the outputs themselves, those that the network will delay, or
  // `lost` where the part is silent and no controller may see them.
  std::vector<double>& readings(std::vector<double>& lost);
  // Writes and readings that are under way when the quality changes arrive at once. `seed`: of its chance.
  void set_network(const NetworkModel::Quality& quality, std::uint64_t seed);
};

// Makes a part of a kind. It is hwparts::make_part, except where parts stand in front of real hardware.
using PartMaker =
    std::function<std::unique_ptr<hwparts::Part>(const std::string& kind, const hwparts::PartContext&)>;

// Make a part, or a sensor, whose ports have their initial values. Throw ConfigError where its entry is
// wrong.
BoundPart make_bound_part(const scene::Scene& scene, const scene::PartPlan& plan, const PartMaker& make);
BoundPart make_bound_sensor(const scene::Scene& scene, const scene::SensorPlan& plan);
// The sensor of a part that make_bound_sensor() made.
sensors::Sensor* sensor_of(const BoundPart& bound);
// Sets the ports to their initial values.
void start_ports(BoundPart& bound);

// Bounds the memory of all cameras together: each keeps a direction for every pixel, and pictures.
class PixelBudget {
 public:
  void take(const sensors::Sensor& sensor, const scene::SensorPlan& plan);

 private:
  std::size_t pixels_ = 0;
};

}  // namespace visum::cycle
