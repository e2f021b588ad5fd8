// Leases: the exclusive right of one session to command a part.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

namespace visum::gateway {

struct Lease {
  std::uint64_t session = 0;   // 0: free
  std::string owner;           // the client's name
  std::uint64_t epoch = 0;     // counts the grants
  std::uint64_t sequence = 0;  // of the last write that carried one
};

// The session of a lease that an agent of the scene holds, for as long as the scene stands.
inline constexpr std::uint64_t kAgentsSession = ~std::uint64_t{0};

// One lease for each part. Lives on the sessions' thread; Parts owns it.
class Leases {
 public:
  explicit Leases(std::size_t parts) : leases_(parts) {}
  void grow(std::size_t parts) { leases_.resize(std::max(parts, leases_.size())); }

  const Lease& of(std::size_t part) const { return leases_[part]; }
  bool held_by(std::size_t part, std::uint64_t session) const { return leases_[part].session == session; }

  std::uint64_t grant(std::size_t part, std::uint64_t session, const std::string& owner) {
    auto& lease = leases_[part];
    lease = {session, owner, lease.epoch + 1, 0};
    return lease.epoch;
  }
  void free(std::size_t part) { leases_[part] = {0, {}, leases_[part].epoch, 0}; }

  // True if a write's number is newer than that of the last write. 0: the client does not count its writes.
  bool is_new(std::size_t part, std::uint64_t sequence) const {
    return sequence == 0 || sequence > leases_[part].sequence;
  }
  void take_sequence(std::size_t part, std::uint64_t sequence) {
    if (sequence != 0) leases_[part].sequence = sequence;
  }

 private:
  std::vector<Lease> leases_;
};

}  // namespace visum::gateway
