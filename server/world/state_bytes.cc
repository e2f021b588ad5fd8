// A saved state: the tick, then each list as its length (64 bits) and its items' fields in the order of their
// declaration; quaternions as x y z w. Native endianness: a snapshot stays on its machine.
#define XXH_INLINE_ALL
#include <xxhash.h>

#include "server/world/world_state.h"

namespace visum::world {
namespace {

class Appender {
 public:
  explicit Appender(std::vector<std::byte>& bytes) : bytes_(bytes) {}

  template <typename T>
  void put(const T* items, std::size_t count) {
    const auto span = std::as_bytes(std::span(items, count));
    bytes_.insert(bytes_.end(), span.begin(), span.end());
  }
  void put(std::uint64_t value) { put(&value, 1); }
  void put(double value) { put(&value, 1); }
  template <typename Derived>
  void put(const Eigen::PlainObjectBase<Derived>& vector) {
    put(vector.data(), static_cast<std::size_t>(vector.size()));
  }

 private:
  std::vector<std::byte>& bytes_;
};

void put_body(Appender& to, const BodyState& body) {
  to.put(body.p_WC);
  to.put(body.q_WB.coeffs());
  to.put(body.v_WC);
  to.put(body.w_WB);
}

void put_joint(Appender& to, const JointState& joint) {
  to.put(joint.position);
  to.put(joint.velocity);
  to.put(joint.effort);
}

}  // namespace

void save(const WorldState& state, std::vector<std::byte>& bytes) {
  Appender to(bytes);
  to.put(static_cast<std::uint64_t>(state.tick));
  to.put(state.bodies.size());
  for (const BodyState& body : state.bodies) put_body(to, body);
  to.put(state.joints.size());
  for (const JointState& joint : state.joints) put_joint(to, joint);
  to.put(state.random.size());
  to.put(state.random.data(), state.random.size());
  to.put(state.engines.size());
  for (const auto& engine : state.engines) {
    to.put(engine.size());
    to.put(engine.data(), engine.size());
  }
}

std::uint64_t hash_bytes(std::span<const std::byte> bytes) {
  return XXH64(bytes.data(), bytes.size(), 0);
}

}  // namespace visum::world
