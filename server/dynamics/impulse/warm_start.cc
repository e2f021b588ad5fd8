#include "server/dynamics/impulse/warm_start.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace visum::dynamics::impulse {
namespace {

// The record of a contact, as it stands in the bytes.
struct Record {
  std::int32_t shape_a, shape_b, feature, rest;
  double impulse[3], twist[3], change[3];
};
static_assert(sizeof(Record) == WarmStart::kBytes);

// A stop that pushes has such a record, too: before all contacts, with this as its shape_a, its joint as
// shape_b, its side as feature, and two numbers of `impulse` (Axis::KeptStop).
constexpr std::int32_t kStop = -1;

bool pushes(const Plant& plant, const Axis& axis, std::size_t side) {
  return plant.mechanism_asleep[axis.mechanism] ? axis.kept_stops[side].impulse != 0.0
                                                : axis.stopped[side][kAhead] != 0.0;
}

// Calls act(axis, side) for each stop that has pushed in this tick.
template <typename Act>
void for_pushing_stops(const Plant& plant, Act act) {
  for (const Axis& axis : plant.axes)
    if (axis.model->limited)
      for (const std::size_t side : {0, 1})
        if (pushes(plant, axis, side)) act(axis, side);
}

Vector3d vector(const double (&from)[3]) {
  return {from[0], from[1], from[2]};
}

// The lowest bit of a record's `rest`: its island has rested. The next two: for how many steps it was still.
// The others: how deep it has landed, in nm.
std::int32_t packed_rest(const Touch& touch) {
  const int still = touch.asleep ? touch.was_still : touch.still;
  return 8 * static_cast<std::int32_t>(std::lround(touch.landed / kSmallestRiseM)) + 2 * still +
         (touch.rested.value_or(false) ? 1 : 0);
}
void unpack_rest(std::int32_t rest, Touch& touch) {
  touch.rested = (rest & 1) != 0;
  touch.was_still = std::min((rest >> 1) & 3, kStillSteps);
  touch.landed = std::clamp(kSmallestRiseM * (rest / 8), 0.0, kDeepestLandingM);
}

auto key_of(const Record& record) {
  return std::tuple(record.shape_a, record.shape_b, record.feature);
}

Record record_at(std::span<const std::byte> bytes, std::size_t i) {
  Record record;
  std::memcpy(&record, bytes.data() + i * sizeof(Record), sizeof(Record));
  return record;
}

// Reads the mechanisms' predictions. Returns the bytes behind them.
std::span<const std::byte> read_predictions(std::span<const std::byte> bytes, Plant& plant) {
  for (Mechanism& mechanism : plant.mechanisms) {
    const std::size_t size = std::min(mechanism.prediction().bytes(), bytes.size());
    mechanism.prediction().read(bytes.first(size));
    bytes = bytes.subspan(size);
  }
  return bytes;
}

// Writes them. Returns the space behind them.
std::span<std::byte> write_predictions(const Plant& plant, std::span<std::byte> bytes) {
  for (const Mechanism& mechanism : plant.mechanisms) {
    const std::size_t size = mechanism.prediction().bytes();
    mechanism.prediction().write(bytes.first(size));
    bytes = bytes.subspan(size);
  }
  return bytes;
}

// Reads the records of stops, which are in the order of the axes. Returns how many there are.
std::size_t read_stops(std::span<const std::byte> bytes, std::size_t count, Plant& plant) {
  std::size_t i = 0, k = 0;
  for (; i < count; ++i) {
    const Record record = record_at(bytes, i);
    if (record.shape_a != kStop) break;
    while (k < plant.axes.size() && plant.axes[k].joint.value != record.shape_b) ++k;
    const bool sane = std::isfinite(record.impulse[0]) && std::isfinite(record.impulse[1]);
    if (k == plant.axes.size() || !sane || record.feature < 0 || record.feature > 1) continue;
    plant.axes[k].kept_stops[static_cast<std::size_t>(record.feature)] = {record.impulse[0],
                                                                          record.impulse[1]};
  }
  return i;
}

void write_record(const Record& record, std::span<std::byte>& to) {
  std::memcpy(to.data(), &record, sizeof(Record));
  to = to.subspan(sizeof(Record));
}

void write_stop(const Plant& plant, const Axis& axis, std::size_t side, std::span<std::byte>& to) {
  Axis::KeptStop kept = axis.kept_stops[side];
  const auto& stopped = axis.stopped[side];
  if (!plant.mechanism_asleep[axis.mechanism]) kept = {stopped[kAhead], stopped[kAfter] - stopped[kAhead]};
  write_record(
      {kStop, axis.joint.value, static_cast<std::int32_t>(side), 0, {kept.impulse, kept.change, 0.0}, {}, {}},
      to);
}

// True if the body belongs to a mechanism.
bool is_jointed(const Plant& plant, int body) {
  return body >= 0 && plant.places[static_cast<std::size_t>(body)].mechanism >= 0;
}

// True if the next tick starts either moment from what it was given. Where joints take part, drives do so,
// too. Where nothing moves, either moment needs what it was given.
bool starts_apart(const Plant& plant, const Touch& touch) {
  return touch.still > 0 || is_jointed(plant, touch.a) || is_jointed(plant, touch.b);
}

// In W.
Vector3d to_start_from(const Touch& touch, const std::array<Vector3d, kMoments>& given, bool apart) {
  if (apart) return touch.frame * given[kAhead];
  return touch.frame * (0.5 * (given[kAhead] + given[kAfter]));
}

}  // namespace

WarmStart read_warm_start(std::span<const std::byte> bytes, std::span<const collision::Contact> contacts,
                          Plant& plant) {
  bytes = read_predictions(bytes, plant);
  if (bytes.size() % sizeof(Record) != 0) return {};
  const std::size_t count = bytes.size() / sizeof(Record);
  std::size_t i = read_stops(bytes, count, plant);
  // Touches and records are sorted alike: one pass finds the pairs.
  for (Touch& touch : plant.touches) {
    const collision::Contact& contact = contacts[touch.contact];
    while (i < count && key_of(record_at(bytes, i)) < key_of(contact)) ++i;
    if (i == count) break;
    if (key_of(record_at(bytes, i)) == key_of(contact)) touch.record = i;
  }
  return {bytes};
}

void WarmStart::load(Touch& touch) const {
  if (touch.record == TouchEnds::kNew) return;
  const Record record = record_at(records_, touch.record);
  const Vector3d impulse = vector(record.impulse), twist = vector(record.twist);
  const Vector3d change = vector(record.change);
  // A contact with bad numbers starts from zero, as a new one does.
  if (!impulse.allFinite() || !twist.allFinite() || !change.allFinite()) return;
  unpack_rest(record.rest, touch);
  touch.kept_impulse = impulse;
  touch.kept_twist = twist;
  touch.kept_change = change;
  start_ahead(touch);
}

std::size_t warm_start_bytes(const Plant& plant) {
  std::size_t size = plant.touches.size() * sizeof(Record);
  for_pushing_stops(plant, [&](const Axis&, std::size_t) { size += sizeof(Record); });
  for (const Mechanism& mechanism : plant.mechanisms) size += mechanism.prediction().bytes();
  return size;
}

void write_warm_start(const Plant& plant, std::span<const collision::Contact> contacts, const WarmStart& from,
                      std::vector<std::byte>& bytes) {
  std::span<std::byte> records = write_predictions(plant, bytes);
  for_pushing_stops(plant,
                    [&](const Axis& axis, std::size_t side) { write_stop(plant, axis, side, records); });
  for (std::size_t i = 0; i < plant.touches.size(); ++i) {
    const Touch& touch = plant.touches[i];
    if (touch.stands) {
      std::ranges::copy(from.record(touch), records.begin());
      records = records.subspan(WarmStart::kBytes);
      continue;
    }
    const collision::Contact& contact = contacts[touch.contact];
    const bool apart = starts_apart(plant, touch);
    // A contact that sleeps or is frozen keeps its impulses as they are, to the last bit.
    Vector3d impulse = touch.kept_impulse, twist = touch.kept_twist, change = touch.kept_change;
    if (!touch.asleep && !touch.frozen) {
      change.setZero();
      if (apart) change = touch.frame * (touch.impulse[kAfter] - touch.impulse[kAhead]);
      impulse = to_start_from(touch, touch.impulse, apart);
      twist.setZero();
      if (is_held_from_turning(touch)) twist = to_start_from(touch, touch.twist, apart);
    }
    const Record record{contact.shape_a.value,
                        contact.shape_b.value,
                        contact.feature,
                        packed_rest(touch),
                        {impulse.x(), impulse.y(), impulse.z()},
                        {twist.x(), twist.y(), twist.z()},
                        {change.x(), change.y(), change.z()}};
    write_record(record, records);
  }
}

}  // namespace visum::dynamics::impulse
