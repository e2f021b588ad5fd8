#include "tests/hwparts/rig.h"

#include <cmath>

namespace visum::test {

hwparts::PartContext arm_context(double tick_s, double angle, double finger, const std::string& more) {
  const std::string entry =
      "{name: arm, kind: amtec_arm, model: arm, drives: models/amtec_arm/drives.yaml" + more + "}";
  hwparts::PartContext context{"arm", config::load_text(entry, "scene", VISUM_SOURCE_DIR), {}, tick_s};
  for (int i = 1; i <= 7; ++i)
    context.joints.push_back({"joint_" + std::to_string(i), false, -3.0, 3.0, angle});
  for (const char* side : {"left", "right"}) {
    context.joints.push_back({"finger_" + std::string(side) + "_joint", true, 0.0, 0.0342, finger});
  }
  return context;
}

drive::DriveData arm_drive(int number) {
  return servo_group::load_drives(arm_context()).drives.at(static_cast<std::size_t>(number) - 1).data;
}

drive::DriveData ideal(drive::DriveData data) {
  data.gear.stiffness = data.gear.damping = data.gear.backlash = 0.0;
  data.gear.viscous_friction = data.gear.coulomb_friction = 0.0;
  data.loop.speed_filter = 0.0;
  return data;
}

Rig::Rig(const drive::DriveData& data, double tick, double position, std::size_t joints,
         const drive::Load& load)
    : tick_s(tick),
      drive(data, position, true, tick, load),
      plants(joints),
      samples_(joints),
      drives_(joints) {
  for (auto& plant : plants) {
    plant.joint.position = position / static_cast<double>(joints);
    plant.by_mean_speed = load.moves_by_mean_speed;
    if (load.inertia > 0.0) plant.inertia = load.inertia * static_cast<double>(joints);
  }
  command = {position, data.limits.maximum_speed, true};
}

void Rig::tick() {
  for (std::size_t i = 0; i < plants.size(); ++i) samples_[i] = plants[i].joint;
  drive.act(command, samples_, drives_);
  for (std::size_t i = 0; i < plants.size(); ++i) {
    plants[i].step(drives_[i], tick_s);
    samples_[i] = plants[i].joint;
  }
  drive.publish(samples_);
}

void Rig::put(const drive::DriveState& state) {
  std::vector<std::byte> saved;
  {
    hwparts::StateWriter writer(saved);
    drive::save(state, writer);
  }
  hwparts::StateReader reader(saved);
  drive.load(reader);
}

void Rig::run(double seconds) {
  const auto ticks = static_cast<std::int64_t>(std::llround(seconds / tick_s));
  for (std::int64_t i = 0; i < ticks; ++i) tick();
}

}  // namespace visum::test
