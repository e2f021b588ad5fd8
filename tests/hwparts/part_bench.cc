#include "tests/hwparts/part_bench.h"

#include <cmath>
#include <stdexcept>

#include "hwparts/kinds/part_kinds.h"

namespace visum::test {
namespace {

std::size_t index_of(const std::vector<protocol::Port>& ports, const std::string& name) {
  for (std::size_t i = 0; i < ports.size(); ++i) {
    if (ports[i].name == name) return i;
  }
  throw std::runtime_error("no port " + name);
}

}  // namespace

PartBench::PartBench(const std::string& kind, const hwparts::PartContext& context)
    : part(hwparts::make_part(kind, context)), tick_s(context.tick_s) {
  for (const auto& port : part->description().controller_inputs) inputs.push_back(port.initial);
  for (const auto& port : part->description().sensor_outputs) outputs.push_back(port.initial);
  for (std::size_t joint : part->joints()) {
    Plant plant;
    plant.joint.position = context.joints[joint].initial_position;
    if (context.joints[joint].prismatic) plant.inertia = 0.1;
    plants.push_back(plant);
  }
  samples_.resize(plants.size());
  drives_.resize(plants.size());
}

void PartBench::tick() {
  for (std::size_t i = 0; i < plants.size(); ++i) samples_[i] = plants[i].joint;
  part->act(inputs, samples_, drives_);
  for (std::size_t i = 0; i < plants.size(); ++i) {
    plants[i].step(drives_[i], tick_s);
    samples_[i] = plants[i].joint;
  }
  part->publish(samples_, outputs);
}

void PartBench::run(double seconds) {
  const auto ticks = static_cast<std::int64_t>(std::llround(seconds / tick_s));
  for (std::int64_t i = 0; i < ticks; ++i) tick();
}

double& PartBench::in(const std::string& name) {
  return inputs[index_of(part->description().controller_inputs, name)];
}

double PartBench::out(const std::string& name) const {
  return outputs[index_of(part->description().sensor_outputs, name)];
}

std::uint32_t PartBench::module(int number) const {
  return static_cast<std::uint32_t>(out("Module State " + std::to_string(number)));
}

void PartBench::set_angles(double value) {
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    if (part->description().controller_inputs[i].group == "Desired Angle") inputs[i] = value;
  }
}

std::vector<std::byte> PartBench::save() const {
  std::vector<std::byte> bytes;
  {
    hwparts::StateWriter writer(bytes);
    part->save(writer);
  }
  return bytes;
}

void PartBench::load(const std::vector<std::byte>& bytes) {
  hwparts::StateReader reader(bytes);
  part->load(reader);
  if (!reader.at_end()) throw std::runtime_error("the part left bytes of its state unread");
}

}  // namespace visum::test
