// The hash of a campaign: XXH64 over number, parameters, exit code and state hash of each run, in order.
// CAMPAIGNS.md says which bytes. One thread.
#pragma once

#include <cstddef>
#include <cstdint>

#include "clients/visum/campaign/results.h"

struct XXH64_state_s;

namespace visum::campaign {

class RunHash {
 public:
  RunHash();
  ~RunHash();
  RunHash(const RunHash&) = delete;
  RunHash& operator=(const RunHash&) = delete;

  void take(const Row& row);
  std::uint64_t value() const;

 private:
  void take_number(std::uint64_t number);
  XXH64_state_s* state_;
};

// The hash of those runs with these numbers that are there.
std::uint64_t hash_of_runs(Results& results, std::size_t first, std::size_t last);

}  // namespace visum::campaign
