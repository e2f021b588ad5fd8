#include "server/dynamics/impulse/prediction.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "server/dynamics/impulse/lanes/kernels.h"

namespace visum::dynamics::impulse {
namespace {

constexpr std::uint64_t kMark = 0x3154'4a44'4552'5056;  // "VPREDJT1"
constexpr std::size_t kLine = 2;                        // steps until the line is known
constexpr std::size_t kKnown = 4;                       // steps until K is known as well

struct Header {
  std::uint64_t mark, newest, count;
  double lengths[2];
};

// The kernels rely on this layout.
static_assert(sizeof(JointImpulse) == 6 * sizeof(double));

const double* numbers(const JointImpulse* from) {
  return from->w.data();
}

}  // namespace

Prediction::Prediction(std::size_t joints)
    : given_(2 * joints), line_(joints), foreseen_(joints), past_(2 * joints) {
  static_assert(sizeof(Past) == 12 * sizeof(float));
}

// The line F(s) = f + g s has the mean f - g h1/2 over step 1 and f - g (h1 + h2/2) over step 2. Its impulse
// is lambda = h (f/2 + g h/6).
void Prediction::begin(double h) {
  if (empty()) return;
  std::memset(static_cast<void*>(given_.data()), 0, given_.size() * sizeof(JointImpulse));
  h_ = h;
  ready_ = count_ >= kLine;
  if (!ready_) return;
  const double h1 = lengths_[newest_], h2 = lengths_[1 - newest_];
  const double slope = h * (0.25 * h1 + h / 6.0) / (0.5 * (h1 + h2));
  const std::array<double, 2> given_weights{(0.5 * h + slope) / h1, -slope / h2};
  // K grows with h^2 and goes on as a line. After one known miss it stays constant, before that it is 0.
  const double on = h1 / h2;
  std::array<double, 2> missed_weights{(1.0 + on) * (h / h1) * (h / h1), -on * (h / h2) * (h / h2)};
  if (count_ < kKnown) missed_weights = {count_ > kLine ? (h / h1) * (h / h1) : 0.0, 0.0};
  ready_ = std::isfinite(slope + on);
  kernels().foresee_joints(line_.size(), given_weights.data(), missed_weights.data(), last()->given.data(),
                           before()->given.data(), line_.front().w.data(), foreseen_.front().w.data());
}

void Prediction::end() {
  if (empty()) return;
  const JointImpulse *ahead = given_.data(), *after = ahead + line_.size();
  kernels().keep_joints(line_.size(), numbers(ahead), numbers(after),
                        ready_ ? numbers(line_.data()) : nullptr, before()->given.data());
  newest_ = 1 - newest_;
  lengths_[newest_] = h_;
  count_ = std::min(count_ + 1, kKnown);
}

std::size_t Prediction::bytes() const {
  return empty() ? 0 : sizeof(Header) + past_.size() * sizeof(Past);
}

// write() must say the same after it, whatever was there before.
void Prediction::clear() {
  std::fill(past_.begin(), past_.end(), Past{});
  lengths_ = {};
  newest_ = count_ = 0;
}

void Prediction::read(std::span<const std::byte> from) {
  if (empty()) return;
  Header header{};
  if (from.size() == bytes()) std::memcpy(&header, from.data(), sizeof(header));
  if (header.mark != kMark || header.newest > 1 || header.count > kKnown) return clear();
  lengths_ = {header.lengths[0], header.lengths[1]};
  newest_ = header.newest;
  count_ = header.count;
  std::memcpy(past_.data(), from.data() + sizeof(header), past_.size() * sizeof(Past));
}

void Prediction::write(std::span<std::byte> to) const {
  if (empty()) return;
  const Header header{kMark, newest_, count_, {lengths_[0], lengths_[1]}};
  std::memcpy(to.data(), &header, sizeof(header));
  std::memcpy(to.data() + sizeof(header), past_.data(), past_.size() * sizeof(Past));
}

}  // namespace visum::dynamics::impulse
