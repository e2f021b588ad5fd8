// The joints' and contacts' impulses of the last ticks, from which the next one's solution starts: an
// engine's own part of the world's state, so that a restored world goes on with the same bits. A contact's of
// free bodies are the mean of those of the look-ahead and of the end of the step: what the one gave too much,
// to move a contact to its place, the other took back.
//
// Format: for each mechanism that predicts, what its prediction writes (prediction.h); then one record for
// each contact, in their order: shape_a, shape_b, feature, whether all have rested (32 bits each), impulse
// and twist in W (3 doubles each). Native endianness, as the rest of a snapshot. What sleeps keeps its
// record.
#pragma once

#include <cstddef>
#include <vector>

#include "server/dynamics/impulse/plant.h"

namespace visum::dynamics::impulse {

// Into the mechanisms' predictions and the touches' impulses. Records of contacts that are gone, and bytes of
// another engine, count for nothing.
void read_warm_start(std::span<const std::byte> bytes, std::span<const collision::Contact> contacts,
                     Plant& plant);
std::size_t warm_start_bytes(const Plant& plant);
void write_warm_start(const Plant& plant, std::span<const collision::Contact> contacts,
                      std::vector<std::byte>& bytes);  // the first warm_start_bytes()

}  // namespace visum::dynamics::impulse
