// The warm start: impulses of joints and contacts in the last ticks, from which the next tick's solution
// starts. It is the engine's own part of the world's state, so a restored world goes on with the same bits. A
// contact between free bodies that move keeps the mean of the impulses at the look-ahead and at the end of
// the step: if the first gave too much, to move a contact to its place, the second took it back.
//
// Format: for each mechanism that predicts, the bytes of its prediction (prediction.h). Then one record for
// each joint's stop that pushes, as if it were a contact (warm_start.cc), and one for each contact, in their
// order: shape_a, shape_b, feature, rest and landing (32 bits each, warm_start.cc), impulse and twist in W,
// and by how much the end of the step gave more than the look-ahead (3 doubles each; the last is 0 between
// free bodies that move). Native endianness, as the rest of a snapshot. A sleeping contact keeps its record.
#pragma once

#include <cstddef>
#include <span>
#include <tuple>
#include <vector>

#include "server/dynamics/impulse/plant.h"

namespace visum::dynamics::impulse {

// Contacts and records are sorted by it.
inline auto key_of(const collision::Contact& contact) {
  return std::tuple(contact.shape_a.value, contact.shape_b.value, contact.feature);
}

// The records of contacts in the bytes that read_warm_start() has looked at. The bytes must outlive it.
// Several threads may read from it.
class WarmStart {
 public:
  static constexpr std::size_t kBytes = 88;  // of a record
  using Bytes = std::span<const std::byte, kBytes>;

  WarmStart(std::span<const std::byte> records = {}) : records_(records) {}
  void load(Touch& touch) const;  // reads the touch's record, if it has one
  // The record of a touch that has one.
  Bytes record(const TouchEnds& touch) const {
    return records_.subspan(kBytes * touch.record).first<kBytes>();
  }

 private:
  std::span<const std::byte> records_;
};

// Reads it into the mechanisms' predictions, and tells the touches which records are theirs. Records of
// contacts that no longer exist, and bytes of another engine, are ignored.
WarmStart read_warm_start(std::span<const std::byte> bytes, std::span<const collision::Contact> contacts,
                          Plant& plant);
std::size_t warm_start_bytes(const Plant& plant);
// Writes the first warm_start_bytes() of `bytes`, which are not those that `from` reads.
void write_warm_start(const Plant& plant, std::span<const collision::Contact> contacts, const WarmStart& from,
                      std::vector<std::byte>& bytes);

}  // namespace visum::dynamics::impulse
