#include "clients/visum/campaign/run_hash.h"

#include <xxhash.h>

namespace visum::campaign {

RunHash::RunHash() : state_(XXH64_createState()) {
  XXH64_reset(state_, 0);
}

RunHash::~RunHash() {
  XXH64_freeState(state_);
}

void RunHash::take(const Row& row) {
  take_number(row.run);
  XXH64_update(state_, row.parameters.c_str(), row.parameters.size() + 1);
  take_number(static_cast<std::uint64_t>(row.code));
  take_number(row.state_hash);
}

std::uint64_t RunHash::value() const {
  return XXH64_digest(state_);
}

void RunHash::take_number(std::uint64_t number) {
  unsigned char bytes[8];
  for (auto& byte : bytes) {
    byte = static_cast<unsigned char>(number & 0xff);
    number >>= 8;
  }
  XXH64_update(state_, bytes, sizeof bytes);
}

std::uint64_t hash_of_runs(Results& results, std::size_t first, std::size_t last) {
  RunHash hash;
  results.for_each(first, last, [&](const Row& row) { hash.take(row); });
  return hash.value();
}

}  // namespace visum::campaign
