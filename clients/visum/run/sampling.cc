#include "clients/visum/run/sampling.h"

#include <algorithm>
#include <bit>
#include <boost/random/sobol.hpp>

#include "clients/visum/run/sweep.h"

namespace visum::run {
namespace {

using config::Node;

// Mixes all bits: the finisher of SplitMix64 (Steele, Lea and Flood, OOPSLA 2014).
std::uint64_t mixed(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9;
  x = (x ^ (x >> 27)) * 0x94d049bb133111eb;
  return x ^ (x >> 31);
}

std::uint64_t mixed(std::uint64_t seed, std::uint64_t axis, std::uint64_t number) {
  return mixed(mixed(mixed(seed) ^ axis) ^ number);
}

// In (0, 1), by the upper 52 bits.
double share_of(std::uint64_t bits) {
  return (static_cast<double>(bits >> 12) + 0.5) * 0x1p-52;
}

// Where `index` stands in a shuffled order of `count`: a Feistel network over the next power of 4, walked
// until it ends below `count`. As a permutation it needs no table.
std::uint64_t shuffled(std::uint64_t index, std::uint64_t count, std::uint64_t key) {
  const int half = std::max<int>(1, (std::bit_width(count - 1) + 1) / 2);
  const std::uint64_t mask = (std::uint64_t{1} << half) - 1;
  do {
    std::uint64_t left = index >> half, right = index & mask;
    for (std::uint64_t round = 0; round < 6; ++round) {
      const std::uint64_t next = left ^ (mixed(key, round, right) & mask);
      left = right;
      right = next;
    }
    index = (left << half) | right;
  } while (index >= count);
  return index;
}

// Coordinate `axis` of point `index` of Sobol's sequence, as 32 bits. Point 0 is the origin, which Boost
// leaves out.
std::uint32_t sobol(std::size_t axis, std::uint64_t index) {
  if (index == 0) return 0;
  boost::random::sobol_engine<std::uint32_t, 32> sequence(axis + 1);
  sequence.seed(static_cast<std::uint32_t>(index - 1));
  std::uint32_t bits = 0;
  for (std::size_t i = 0; i <= axis; ++i) bits = sequence();
  return bits;
}

}  // namespace

double random_share(std::uint64_t seed, std::size_t axis, std::uint64_t number) {
  return share_of(mixed(seed, axis, number));
}

std::optional<Sampling> Sampling::read(const Node& root) {
  const auto node = root.find("sampling");
  if (!node) return std::nullopt;
  if (node->kind() != Node::Kind::kMap) node->fail("must be a map: {method: sobol, runs: 1000}");
  node->allow_only({"method", "runs", "seed"});
  Sampling result;
  const std::string method = node->get("method").one_of({"random", "latin_hypercube", "sobol"});
  if (method == "latin_hypercube") result.method_ = Method::kLatinHypercube;
  if (method == "sobol") result.method_ = Method::kSobol;
  result.runs_ = static_cast<std::size_t>(node->get("runs").integer(1, Sweep::kMaxRuns));
  if (const auto seed = node->find("seed")) result.seed_ = static_cast<std::uint64_t>(seed->integer(0));
  return result;
}

double Sampling::share(std::size_t axis, std::size_t run) const {
  const std::uint64_t index = run - 1;
  const double loose = random_share(seed_, axis, index);
  switch (method_) {
    case Method::kRandom:
      return loose;
    case Method::kLatinHypercube: {
      const auto piece = static_cast<double>(shuffled(index, runs_, mixed(seed_, axis, ~std::uint64_t{0})));
      return (piece + loose) / static_cast<double>(runs_);
    }
    case Method::kSobol:
      break;
  }
  const auto shift = static_cast<std::uint32_t>(mixed(seed_, axis, ~std::uint64_t{0}));
  return (static_cast<double>(sobol(axis, index) ^ shift) + 0.5) * 0x1p-32;
}

}  // namespace visum::run
