// SHA-256 (FIPS 180-4, section 6.2) and HMAC (RFC 2104). They are written out here, because an emergency stop
// needs them and must not wait for a library to be loaded, nor miss one.
#include "protocol/keyed_hash.h"

#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <stdexcept>

namespace visum::protocol {
namespace {

constexpr std::size_t kBlockBytes = 64;

// The first 32 bits of the fractions of the cube roots of the first 64 primes.
constexpr std::array<std::uint32_t, 64> kRoots{
    0x428a2f98, 0x71374491, 0xb5c0fbcf, 0xe9b5dba5, 0x3956c25b, 0x59f111f1, 0x923f82a4, 0xab1c5ed5,
    0xd807aa98, 0x12835b01, 0x243185be, 0x550c7dc3, 0x72be5d74, 0x80deb1fe, 0x9bdc06a7, 0xc19bf174,
    0xe49b69c1, 0xefbe4786, 0x0fc19dc6, 0x240ca1cc, 0x2de92c6f, 0x4a7484aa, 0x5cb0a9dc, 0x76f988da,
    0x983e5152, 0xa831c66d, 0xb00327c8, 0xbf597fc7, 0xc6e00bf3, 0xd5a79147, 0x06ca6351, 0x14292967,
    0x27b70a85, 0x2e1b2138, 0x4d2c6dfc, 0x53380d13, 0x650a7354, 0x766a0abb, 0x81c2c92e, 0x92722c85,
    0xa2bfe8a1, 0xa81a664b, 0xc24b8b70, 0xc76c51a3, 0xd192e819, 0xd6990624, 0xf40e3585, 0x106aa070,
    0x19a4c116, 0x1e376c08, 0x2748774c, 0x34b0bcb5, 0x391c0cb3, 0x4ed8aa4a, 0x5b9cca4f, 0x682e6ff3,
    0x748f82ee, 0x78a5636f, 0x84c87814, 0x8cc70208, 0x90befffa, 0xa4506ceb, 0xbef9a3f7, 0xc67178f2};

class Sha256 {
 public:
  void add(std::span<const std::byte> bytes) {
    for (const std::byte byte : bytes) {
      block_[count_++ % kBlockBytes] = byte;
      if (count_ % kBlockBytes == 0) take_block();
    }
  }

  KeyedHash finish() {
    const std::uint64_t bits = 8 * count_;
    add(std::array{std::byte{0x80}});
    while (count_ % kBlockBytes != kBlockBytes - 8) add(std::array{std::byte{0}});
    for (int shift = 56; shift >= 0; shift -= 8) add(std::array{static_cast<std::byte>(bits >> shift)});
    KeyedHash hash;
    for (std::size_t i = 0; i < hash.size(); ++i)
      hash[i] = static_cast<std::byte>(state_[i / 4] >> (24 - 8 * (i % 4)));
    return hash;
  }

 private:
  void take_block() {
    std::array<std::uint32_t, 64> w{};
    for (std::size_t i = 0; i < kBlockBytes; ++i)
      w[i / 4] = w[i / 4] << 8 | std::to_integer<std::uint32_t>(block_[i]);
    for (std::size_t t = 16; t < 64; ++t) {
      const std::uint32_t x = w[t - 15], y = w[t - 2];
      w[t] = w[t - 16] + (std::rotr(x, 7) ^ std::rotr(x, 18) ^ x >> 3) + w[t - 7] +
             (std::rotr(y, 17) ^ std::rotr(y, 19) ^ y >> 10);
    }
    auto [a, b, c, d, e, f, g, h] = state_;
    for (std::size_t t = 0; t < 64; ++t) {
      const std::uint32_t first = h + (std::rotr(e, 6) ^ std::rotr(e, 11) ^ std::rotr(e, 25)) +
                                  ((e & f) ^ (~e & g)) + kRoots[t] + w[t];
      const std::uint32_t second =
          (std::rotr(a, 2) ^ std::rotr(a, 13) ^ std::rotr(a, 22)) + ((a & b) ^ (a & c) ^ (b & c));
      h = g;
      g = f;
      f = e;
      e = d + first;
      d = c;
      c = b;
      b = a;
      a = first + second;
    }
    const std::array<std::uint32_t, 8> mixed{a, b, c, d, e, f, g, h};
    for (std::size_t i = 0; i < mixed.size(); ++i) state_[i] += mixed[i];
  }

  // The same of the square roots of the first 8 primes.
  std::array<std::uint32_t, 8> state_{0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a,
                                      0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};
  std::array<std::byte, kBlockBytes> block_{};
  std::uint64_t count_ = 0;  // bytes
};

}  // namespace

KeyedHash keyed_hash(std::span<const std::byte> key, std::span<const std::byte> message) {
  std::array<std::byte, kBlockBytes> padded{};
  if (key.size() > kBlockBytes) {
    Sha256 of_key;
    of_key.add(key);
    std::ranges::copy(of_key.finish(), padded.begin());
  } else {
    std::ranges::copy(key, padded.begin());
  }
  const auto hash_of = [&](std::byte pad, std::span<const std::byte> text) {
    std::array<std::byte, kBlockBytes> masked = padded;
    for (std::byte& byte : masked) byte ^= pad;
    Sha256 hash;
    hash.add(masked);
    hash.add(text);
    return hash.finish();
  };
  return hash_of(std::byte{0x5c}, hash_of(std::byte{0x36}, message));
}

void fill_with_random(std::span<std::byte> bytes) {
  constexpr std::size_t kMostAtOnce = 256;  // of getentropy()
  for (; !bytes.empty(); bytes = bytes.subspan(std::min(bytes.size(), kMostAtOnce)))
    if (::getentropy(bytes.data(), std::min(bytes.size(), kMostAtOnce)) != 0)
      throw std::runtime_error("the system has no random numbers");
}

// The volatile keeps the compiler from leaving the loop early.
bool equal_in_constant_time(const KeyedHash& a, const KeyedHash& b) {
  volatile unsigned char differ = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    differ = static_cast<unsigned char>(differ | std::to_integer<unsigned char>(a[i] ^ b[i]));
  return differ == 0;
}

}  // namespace visum::protocol
