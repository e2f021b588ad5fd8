#include <gtest/gtest.h>

#include <random>

#include "server/dynamics/impulse/lanes/kernels.h"

namespace visum::dynamics::impulse {
namespace {

constexpr std::size_t kJoints = 5;

template <typename Number>
std::vector<Number> random_numbers(std::size_t count, std::mt19937_64& random) {
  std::uniform_real_distribution<Number> range(Number{-3}, Number{3});
  std::vector<Number> numbers(count);
  for (Number& number : numbers) number = range(random);
  return numbers;
}

struct Foreseen {
  std::vector<double> line = std::vector<double>(6 * kJoints), all = line;
  bool operator==(const Foreseen&) const = default;
};

Foreseen foresee(const Kernels& kernels, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto given = random_numbers<double>(2, random), missed = random_numbers<double>(2, random);
  const auto last = random_numbers<float>(12 * kJoints, random);
  const auto before = random_numbers<float>(12 * kJoints, random);
  Foreseen foreseen;
  kernels.foresee_joints(kJoints, given.data(), missed.data(), last.data(), before.data(),
                         foreseen.line.data(), foreseen.all.data());
  return foreseen;
}

std::vector<float> keep(const Kernels& kernels, std::uint64_t seed, bool has_line) {
  std::mt19937_64 random(seed);
  const auto ahead = random_numbers<double>(6 * kJoints, random);
  const auto after = random_numbers<double>(6 * kJoints, random);
  const auto line = random_numbers<double>(6 * kJoints, random);
  std::vector<float> past(12 * kJoints, 7.0f);
  kernels.keep_joints(kJoints, ahead.data(), after.data(), has_line ? line.data() : nullptr, past.data());
  return past;
}

TEST(PredictionKernels, BothBuildsGiveTheSameBits) {
  if (kWideKernels == nullptr || &kernels() != kWideKernels) GTEST_SKIP() << "one build alone";
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    EXPECT_EQ(foresee(kBaselineKernels, seed), foresee(*kWideKernels, seed));
    for (const bool has_line : {false, true})
      EXPECT_EQ(keep(kBaselineKernels, seed, has_line), keep(*kWideKernels, seed, has_line));
  }
}

TEST(PredictionKernels, WeighWhatTheStepsGaveAndMissed) {
  const std::vector<double> given{2.0, 3.0}, missed{5.0, 7.0};
  std::vector<float> last(12), before(12);
  for (std::size_t k = 0; k < 12; ++k) {
    last[k] = static_cast<float>(k);
    before[k] = static_cast<float>(100 * k);
  }
  std::vector<double> line(6), all(6);
  kernels().foresee_joints(1, given.data(), missed.data(), last.data(), before.data(), line.data(),
                           all.data());
  for (std::size_t k = 0; k < 6; ++k) {
    EXPECT_EQ(line[k], 302.0 * static_cast<double>(k));
    EXPECT_EQ(all[k], line[k] + 705.0 * static_cast<double>(k + 6));
  }
}

TEST(PredictionKernels, KeepWhatAStepGaveAndItsLineMissed) {
  const std::vector<double> ahead{1.0, 2.0, 3.0, 4.0, 5.0, 6.0}, after{10.0, 20.0, 30.0, 40.0, 50.0, 60.0};
  const std::vector<double> line{0.5, 1.0, 1.5, 2.0, 2.5, 3.0};
  std::vector<float> past(12);
  kernels().keep_joints(1, ahead.data(), after.data(), line.data(), past.data());
  EXPECT_EQ(past, (std::vector<float>{11, 22, 33, 44, 55, 66, 0.5, 1, 1.5, 2, 2.5, 3}));
  kernels().keep_joints(1, ahead.data(), after.data(), nullptr, past.data());
  EXPECT_EQ(past, (std::vector<float>{11, 22, 33, 44, 55, 66, 0, 0, 0, 0, 0, 0}));
}

}  // namespace
}  // namespace visum::dynamics::impulse
