#include "protocol/keyed_hash.h"

#include <nettle/hmac.h>
#include <nettle/memops.h>
#include <string.h>
#include <unistd.h>

#include <algorithm>
#include <stdexcept>

namespace visum::protocol {
namespace {

const std::uint8_t* octets(std::span<const std::byte> bytes) {
  return reinterpret_cast<const std::uint8_t*>(bytes.data());
}

}  // namespace

KeyedHash keyed_hash(std::span<const std::byte> key, std::span<const std::byte> message) {
  hmac_sha256_ctx context;
  hmac_sha256_set_key(&context, key.size(), octets(key));
  hmac_sha256_update(&context, message.size(), octets(message));
  KeyedHash hash;
  hmac_sha256_digest(&context, hash.size(), reinterpret_cast<std::uint8_t*>(hash.data()));
  ::explicit_bzero(&context, sizeof context);  // it tells the key
  return hash;
}

void fill_with_random(std::span<std::byte> bytes) {
  constexpr std::size_t kMostAtOnce = 256;  // of getentropy()
  for (; !bytes.empty(); bytes = bytes.subspan(std::min(bytes.size(), kMostAtOnce)))
    if (::getentropy(bytes.data(), std::min(bytes.size(), kMostAtOnce)) != 0)
      throw std::runtime_error("the system has no random numbers");
}

bool equal_in_constant_time(const KeyedHash& a, const KeyedHash& b) {
  return memeql_sec(a.data(), b.data(), a.size()) == 1;
}

}  // namespace visum::protocol
