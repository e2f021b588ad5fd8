// Writes and reads a state as bytes: the tick, then each list as its length (64 bits) and its items' fields
// in the order of their declaration, quaternions as x y z w. Native endianness: a snapshot stays on its
// machine.
#define XXH_INLINE_ALL
#include <xxhash.h>

#include <array>
#include <cstring>
#include <limits>

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

 private:
  std::vector<std::byte>& bytes_;
};

// Reads from the front what an Appender wrote. Once the bytes are too few it reads nothing more, and
// complete() is false.
class Taker {
 public:
  explicit Taker(std::span<const std::byte> bytes) : left_(bytes) {}

  template <typename T>
  void take(T* items, std::size_t count) {
    if (count > left_.size() / sizeof(T)) {
      complete_ = false;
      left_ = {};
      return;
    }
    if (count > 0) std::memcpy(items, left_.data(), count * sizeof(T));
    left_ = left_.subspan(count * sizeof(T));
  }
  void take(double& value) { take(&value, 1); }
  template <typename Derived>
  void take(Eigen::PlainObjectBase<Derived>& vector) {
    take(vector.data(), static_cast<std::size_t>(vector.size()));
  }
  // Reads the length of a list that must have this length.
  void expect(std::size_t length) {
    std::uint64_t found = 0;
    take(&found, 1);
    complete_ = complete_ && found == length;
  }
  template <typename T>
  void take_list(std::vector<T>& list) {
    std::uint64_t length = 0;
    take(&length, 1);
    if (length > left_.size() / sizeof(T)) complete_ = false;
    list.resize(complete_ ? length : 0);
    take(list.data(), list.size());
  }
  bool complete() const { return complete_; }
  std::span<const std::byte> left() const { return left_; }

 private:
  std::span<const std::byte> left_;
  bool complete_ = true;
};

void put_body(Appender& to, const BodyState& body) {
  std::array<double, 13> numbers;
  Eigen::Map<Eigen::Matrix<double, 13, 1>>(numbers.data()) << body.p_WC, body.q_WB.coeffs(), body.v_WC,
      body.w_WB;
  to.put(numbers.data(), numbers.size());
}

void put_joint(Appender& to, const JointState& joint) {
  const std::array<double, 3> numbers{joint.position, joint.velocity, joint.effort};
  to.put(numbers.data(), numbers.size());
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
  // A world of one engine has the bytes that it always had.
  if (state.engines.size() < 2) return;
  to.put(state.coupling.size());
  to.put(state.coupling.data(), state.coupling.size());
}

std::span<const std::byte> load(std::span<const std::byte> bytes, const WorldModel& model, WorldState& state,
                                std::string& fault) {
  Taker from(bytes);
  WorldState taken;
  from.take(&taken.tick, 1);
  from.expect(model.bodies.size());
  taken.bodies.resize(model.bodies.size());
  for (BodyState& body : taken.bodies) {
    from.take(body.p_WC);
    from.take(body.q_WB.coeffs());
    from.take(body.v_WC);
    from.take(body.w_WB);
  }
  from.expect(model.joints.size());
  taken.joints.resize(model.joints.size());
  for (JointState& joint : taken.joints)
    for (double* number : {&joint.position, &joint.velocity, &joint.effort}) from.take(*number);
  from.take_list(taken.random);
  from.expect(model.engines.size());
  taken.engines.resize(model.engines.size());
  for (auto& engine : taken.engines) from.take_list(engine);
  if (taken.engines.size() > 1) from.take_list(taken.coupling);
  // Half of the nanoseconds that 64 bits can count: the restored world needs room to go on.
  const std::int64_t last_tick = std::numeric_limits<std::int64_t>::max() / model.tick_ns / 2;
  if (!from.complete() || taken.tick < 0 || taken.tick > last_tick) {
    fault = "the state is not one of this world";
    return {};
  }
  if (!is_sane(model, taken, &fault)) return {};
  state = std::move(taken);
  return from.left();
}

std::uint64_t hash_bytes(std::span<const std::byte> bytes) {
  return XXH64(bytes.data(), bytes.size(), 0);
}

}  // namespace visum::world
