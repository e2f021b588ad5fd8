// HMAC-SHA256, and bytes that nobody can guess. Nettle stays inside keyed_hash.cc: a small library that every
// program is linked to, so that an emergency stop never waits for OpenSSL to be loaded. Any thread.
#pragma once

#include <array>
#include <cstddef>
#include <span>

namespace visum::protocol {

using KeyedHash = std::array<std::byte, 32>;

KeyedHash keyed_hash(std::span<const std::byte> key, std::span<const std::byte> message);
// Throws std::runtime_error where the system has no random numbers.
void fill_with_random(std::span<std::byte> bytes);

// Takes the same time wherever the first difference is.
bool equal_in_constant_time(const KeyedHash& a, const KeyedHash& b);

}  // namespace visum::protocol
