#include "server/dynamics/impulse/sleep.h"

#include <algorithm>
#include <cstring>

namespace visum::dynamics::impulse {
namespace {

constexpr double kAtRest = 1e-4;  // m/s, rad/s: slower counts as standing still

// Each component of both velocities counts, not their length.
bool is_still(const Vector3d& v, const Vector3d& w) {
  return v.cwiseAbs().maxCoeff() <= kAtRest && w.cwiseAbs().maxCoeff() <= kAtRest;
}

// Hash of a unit's drives, one drive after the other.
std::uint64_t hash_of(std::uint64_t before, const hwparts::JointDrive& drive) {
  const std::array<double, 4> values{drive.target_velocity, drive.compliance, drive.max_effort,
                                     drive.feedforward};
  std::array<std::byte, sizeof(values) + sizeof(before)> bytes{};
  std::memcpy(bytes.data(), values.data(), sizeof(values));
  std::memcpy(bytes.data() + sizeof(values), &before, sizeof(before));
  return world::hash_bytes(bytes);
}

}  // namespace

Sleep::Sleep(const Plant& plant) : sleep_s_(plant.setting.sleep_s) {
  std::size_t units = plant.mechanisms.size();
  for (const Place& place : plant.places)
    unit_of_.push_back(place.mechanism >= 0 ? static_cast<std::size_t>(place.mechanism) : units++);
  records_.resize(units);
  islands_ = world::DisjointSets(units);
  drives_.resize(units);
  contacts_.resize(units);
}

std::size_t Sleep::bytes() const {
  return is_wanted() ? records_.size() * sizeof(Record) : 0;
}

// Bytes of another engine, or no bytes yet: nothing sleeps.
void Sleep::read(const std::vector<std::byte>& from) {
  std::fill(records_.begin(), records_.end(), Record{});
  if (from.size() >= bytes()) std::memcpy(records_.data(), from.data() + (from.size() - bytes()), bytes());
}

void Sleep::write(std::vector<std::byte>& to) const {
  if (is_wanted()) std::memcpy(to.data() + (to.size() - bytes()), records_.data(), bytes());
}

void Sleep::join(int body_a, int body_b) {
  if (body_a < 0 || body_b < 0) return;
  islands_.join(unit_of_[static_cast<std::size_t>(body_a)], unit_of_[static_cast<std::size_t>(body_b)]);
}

// A unit that moves is disturbed, also if its velocity was set from outside.
void Sleep::note_motion(const Plant& plant) {
  for (std::size_t i = 0; i < unit_of_.size(); ++i)
    if (!is_still(plant.bodies.v[i], plant.bodies.w[i])) disturb(unit_of_[i]);
}

// Forces disturb at once; drives are compared by their hash, later in begin().
void Sleep::note_inputs(const StepInput& input, const Plant& plant) {
  for (const Wrench& wrench : input.wrenches) {
    const int body = plant.bodies.number(wrench.body);
    if (body >= 0 && !(wrench.force_n.isZero(0.0) && wrench.torque_nm.isZero(0.0)))
      disturb(unit_of_[static_cast<std::size_t>(body)]);
  }
  std::fill(drives_.begin(), drives_.end(), 0);
  for (const Axis& axis : plant.axes)
    drives_[axis.mechanism] = hash_of(drives_[axis.mechanism], input.drives[axis.joint.index()]);
  // Springs join islands, as contacts do.
  for (const Spring& spring : plant.springs) join(spring.spec.a, spring.spec.b);
}

// Contacts join islands. Their number per unit is compared with the last tick's.
void Sleep::note_contacts(const StepInput& input, const world::WorldState& state, const Plant& plant) {
  std::fill(contacts_.begin(), contacts_.end(), 0);
  for (const collision::Contact& contact : input.contacts) {
    const int a = plant.bodies.number(contact.body_a), b = plant.bodies.number(contact.body_b);
    join(a, b);
    for (const auto& [mine, other] : {std::pair{a, contact.body_b}, std::pair{b, contact.body_a}}) {
      if (mine < 0) continue;
      const std::size_t unit = unit_of_[static_cast<std::size_t>(mine)];
      ++contacts_[unit];
      const world::BodyState& body = state.bodies[other.index()];
      const bool moves = !plant.model.bodies[other.index()].fixed && !is_still(body.v_WC, body.w_WB);
      // A body of another engine that moves wakes what it touches.
      if (moves && plant.bodies.number(other) < 0) disturb(unit);
    }
  }
}

void Sleep::begin(const StepInput& input, const world::WorldState& state, const std::vector<std::byte>& from,
                  Plant& plant) {
  if (!is_wanted()) return;
  read(from);
  islands_.separate();
  // A unit stands still for one tick more, unless something disturbs it.
  for (Record& record : records_) record.still_s += input.tick_s;
  note_motion(plant);
  note_inputs(input, plant);
  note_contacts(input, state, plant);
  for (std::size_t i = 0; i < records_.size(); ++i) {
    if (records_[i].drives != drives_[i] || records_[i].contacts != contacts_[i]) disturb(i);
    records_[i].drives = drives_[i];
    records_[i].contacts = contacts_[i];
  }
  mark(plant);
}

// An island has stood still for as long as that unit of it which moved last.
void Sleep::mark(Plant& plant) {
  for (std::size_t i = 0; i < records_.size(); ++i) {
    double& island_s = records_[islands_.leader(i)].still_s;
    island_s = std::min(island_s, records_[i].still_s);
  }
  for (std::size_t i = 0; i < records_.size(); ++i)
    records_[i].still_s = records_[islands_.leader(i)].still_s;
  for (std::size_t i = 0; i < unit_of_.size(); ++i) {
    const bool sleeps = records_[unit_of_[i]].still_s >= sleep_s_;
    plant.asleep[i] = sleeps;
    if (plant.places[i].mechanism >= 0)
      plant.mechanism_asleep[static_cast<std::size_t>(plant.places[i].mechanism)] = sleeps;
    if (sleeps) plant.bodies.v[i] = plant.bodies.w[i] = Vector3d::Zero();
  }
}

}  // namespace visum::dynamics::impulse
