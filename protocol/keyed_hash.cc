#include "protocol/keyed_hash.h"

#include <openssl/crypto.h>
#include <openssl/evp.h>
#include <openssl/hmac.h>
#include <openssl/rand.h>

#include <stdexcept>

namespace visum::protocol {

KeyedHash keyed_hash(std::span<const std::byte> key, std::span<const std::byte> message) {
  KeyedHash hash;
  unsigned int length = 0;
  if (!HMAC(EVP_sha256(), key.data(), static_cast<int>(key.size()),
            reinterpret_cast<const unsigned char*>(message.data()), message.size(),
            reinterpret_cast<unsigned char*>(hash.data()), &length) ||
      length != hash.size())
    throw std::runtime_error("OpenSSL has no HMAC-SHA256");
  return hash;
}

void fill_with_random(std::span<std::byte> bytes) {
  if (RAND_bytes(reinterpret_cast<unsigned char*>(bytes.data()), static_cast<int>(bytes.size())) != 1)
    throw std::runtime_error("OpenSSL has no random numbers");
}

bool equal_in_constant_time(const KeyedHash& a, const KeyedHash& b) {
  return CRYPTO_memcmp(a.data(), b.data(), a.size()) == 0;
}

}  // namespace visum::protocol
