#include "protocol/keyed_hash.h"

#include <openssl/crypto.h>
#include <openssl/evp.h>
#include <openssl/hmac.h>
#include <unistd.h>

#include <algorithm>
#include <new>
#include <stdexcept>

namespace visum::protocol {

KeyedHash keyed_hash(std::span<const std::byte> key, std::span<const std::byte> message) {
  KeyedHash hash;
  unsigned int length = 0;
  if (!HMAC(EVP_sha256(), key.data(), static_cast<int>(key.size()),
            reinterpret_cast<const unsigned char*>(message.data()), message.size(),
            reinterpret_cast<unsigned char*>(hash.data()), &length) ||
      length != hash.size())
    throw std::bad_alloc();  // nothing else is in the way of HMAC-SHA256
  return hash;
}

// By the kernel: OpenSSL would take a millisecond to get ready, in a server that may never need it.
void fill_with_random(std::span<std::byte> bytes) {
  constexpr std::size_t kMostAtOnce = 256;  // of getentropy()
  for (; !bytes.empty(); bytes = bytes.subspan(std::min(bytes.size(), kMostAtOnce)))
    if (::getentropy(bytes.data(), std::min(bytes.size(), kMostAtOnce)) != 0)
      throw std::runtime_error("the system has no random numbers");
}

bool equal_in_constant_time(const KeyedHash& a, const KeyedHash& b) {
  return CRYPTO_memcmp(a.data(), b.data(), a.size()) == 0;
}

}  // namespace visum::protocol
