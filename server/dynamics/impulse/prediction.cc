#include "server/dynamics/impulse/prediction.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace visum::dynamics::impulse {
namespace {

constexpr std::uint64_t kMark = 0x3154'4a44'4552'5056;  // "VPREDJT1"
constexpr std::size_t kLine = 2;                        // steps until the line is known
constexpr std::size_t kKnown = 4;                       // until all is

struct Header {
  std::uint64_t mark, newest, count;
  double lengths[2];
};

JointImpulse wide(const std::array<float, 6>& from) {
  return {{from[0], from[1], from[2]}, {from[3], from[4], from[5]}};
}

std::array<float, 6> narrow(const JointImpulse& from) {
  const auto to = [](double value) { return static_cast<float>(value); };
  return {to(from.w.x()), to(from.w.y()), to(from.w.z()), to(from.v.x()), to(from.v.y()), to(from.v.z())};
}

JointImpulse sum(double a, const JointImpulse& x, double b, const JointImpulse& y) {
  return {a * x.w + b * y.w, a * x.v + b * y.v};
}

}  // namespace

Prediction::Prediction(std::size_t joints)
    : ahead_(joints), after_(joints), line_(joints), past_(2 * joints) {}

// The line F(s) = f + g s, with the means f - g h1/2 over step 1 and f - g (h1 + h2/2) over step 2, gives
// lambda = h (f/2 + g h/6).
void Prediction::begin(double h) {
  std::fill(ahead_.begin(), ahead_.end(), JointImpulse{});
  std::fill(after_.begin(), after_.end(), JointImpulse{});
  h_ = h;
  ready_ = count_ >= kLine;
  if (!ready_) return;
  const double h1 = lengths_[newest_], h2 = lengths_[1 - newest_];
  const double slope = h * (0.25 * h1 + h / 6.0) / (0.5 * (h1 + h2));
  given_weights_ = {(0.5 * h + slope) / h1, -slope / h2};
  const double on = h1 / h2;
  missed_weights_ = {(1.0 + on) * (h / h1) * (h / h1), -on * (h / h2) * (h / h2)};
  if (count_ < kKnown) missed_weights_ = {count_ > kLine ? (h / h1) * (h / h1) : 0.0, 0.0};
  ready_ = std::isfinite(slope + on);
  for (std::size_t i = 0; i < line_.size(); ++i)
    line_[i] = sum(given_weights_[0], wide(last(i).given), given_weights_[1], wide(before(i).given));
}

JointImpulse Prediction::at(std::size_t i) const {
  JointImpulse impulse = line_[i];
  add(impulse, sum(missed_weights_[0], wide(last(i).missed), missed_weights_[1], wide(before(i).missed)));
  return impulse;
}

void Prediction::end() {
  for (std::size_t i = 0; i < ahead_.size(); ++i) {
    Past past{};
    if (ready_) past.missed = narrow(sum(1.0, ahead_[i], -1.0, line_[i]));
    past.given = narrow(sum(1.0, ahead_[i], 1.0, after_[i]));
    past_[(1 - newest_) * ahead_.size() + i] = past;
  }
  newest_ = 1 - newest_;
  lengths_[newest_] = h_;
  count_ = std::min(count_ + 1, kKnown);
}

std::size_t Prediction::bytes() const {
  return empty() ? 0 : sizeof(Header) + past_.size() * sizeof(Past);
}

// As before the first step: what write() says after it is the same whatever was there before.
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
