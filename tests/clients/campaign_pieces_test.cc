// The pieces of campaigns: shards, sampling, statistics.
#include <gmock/gmock.h>

#include <cmath>
#include <map>
#include <set>

#include "clients/visum/campaign/shard.h"
#include "clients/visum/campaign/statistics.h"
#include "clients/visum/common/exit_code.h"
#include "clients/visum/run/distribution.h"
#include "clients/visum/run/sampling.h"
#include "clients/visum/run/sweep.h"
#include "protocol/config/exp_log.h"

namespace visum::campaign {
namespace {

using ::testing::HasSubstr;

std::string refusal(const std::function<void()>& act) {
  try {
    act();
  } catch (const cli::ExitError& error) {
    return error.what();
  } catch (const config::ConfigError& error) {
    return error.what();
  }
  return "nothing was refused";
}

Shard shard_in(const std::map<std::string, std::string>& environment) {
  return shard_from([&](const char* name) {
    const auto found = environment.find(name);
    return found == environment.end() ? nullptr : found->second.c_str();
  });
}

TEST(Shard, RunsGoRoundTheShards) {
  const Shard second = shard_of("2/3");
  EXPECT_FALSE(second.holds(1));
  EXPECT_TRUE(second.holds(2));
  EXPECT_TRUE(second.holds(5));
  EXPECT_EQ(second.runs(5), 2u);
  EXPECT_EQ(second.runs(1), 0u);
  EXPECT_EQ(shard_of("1/1").runs(7), 7u);
}

TEST(Shard, TogetherTheyAreAllRunsOnce) {
  for (const std::size_t all : {1u, 7u, 12u}) {
    std::size_t sum = 0;
    for (std::size_t i = 1; i <= 5; ++i) sum += Shard{i, 5}.runs(all);
    EXPECT_EQ(sum, all);
  }
}

TEST(Shard, NonsenseIsRefused) {
  for (const char* text : {"", "3", "0/3", "4/3", "1/0", "a/b", "1/2/3", "-1/3", "1/2 ", "1/9999999"})
    EXPECT_THAT(refusal([&] { shard_of(text); }), HasSubstr("must be I/N")) << text;
}

TEST(Shard, ComesFromTheClustersTask) {
  EXPECT_EQ(shard_in({{"VISUM_SHARD", "3/4"}, {"SLURM_ARRAY_TASK_ID", "1"}}).text(), "3/4");
  EXPECT_EQ(
      shard_in(
          {{"SLURM_ARRAY_TASK_ID", "12"}, {"SLURM_ARRAY_TASK_MIN", "10"}, {"SLURM_ARRAY_TASK_COUNT", "5"}})
          .text(),
      "3/5");
  EXPECT_EQ(shard_in({{"JOB_COMPLETION_INDEX", "0"}, {"VISUM_SHARD_COUNT", "8"}}).text(), "1/8");
  EXPECT_THAT(refusal([] { shard_in({}); }), HasSubstr("--shard without a value needs VISUM_SHARD=I/N"));
  EXPECT_THAT(refusal([] {
                shard_in({{"JOB_COMPLETION_INDEX", "0"}});
              }),
              HasSubstr("VISUM_SHARD_COUNT is not set"));
  EXPECT_THAT(refusal([] { shard_in({{"VISUM_SHARD", "x"}}); }), HasSubstr("VISUM_SHARD: must be I/N"));
  // An array with gaps, as --array=1,5,9, has no task of that number.
  EXPECT_THAT(
      refusal([] {
        shard_in(
            {{"SLURM_ARRAY_TASK_ID", "9"}, {"SLURM_ARRAY_TASK_MIN", "1"}, {"SLURM_ARRAY_TASK_COUNT", "3"}});
      }),
      HasSubstr("I from 1 to N"));
}

TEST(ExpLog, ComeNearTheCLibrarys) {
  for (double x = -700.0; x < 700.0; x += 0.37)
    EXPECT_NEAR(config::exponential(x) / std::exp(x), 1.0, 4e-16) << x;
  for (double x = 1e-300; x < 1e300; x *= 1.7)
    EXPECT_NEAR(config::logarithm(x), std::log(x), 2.3e-16 * std::max(1.0, std::abs(std::log(x)))) << x;
  for (const double x : {0.9, 0.999999, 1.0, 1.000001, 1.1})
    EXPECT_NEAR(config::logarithm(x), std::log(x), 4e-16 * std::abs(std::log(x))) << x;
  EXPECT_TRUE(std::isnan(config::logarithm(0.0)));
  EXPECT_TRUE(std::isnan(config::logarithm(-1.0)));
  EXPECT_EQ(config::exponential(-800.0), 0.0);
  EXPECT_TRUE(std::isinf(config::exponential(710.0)));
}

// Against the distribution function that the C library has: erfc.
TEST(NormalQuantile, TurnsTheNormalDistributionRound) {
  EXPECT_EQ(run::normal_quantile(0.5), 0.0);
  EXPECT_NEAR(run::normal_quantile(0.975), 1.959963984540054, 1e-14);
  for (const double share : {1e-300, 1e-20, 1e-9, 0.001, 0.07, 0.075, 0.3, 0.7, 0.93, 0.999, 1.0 - 1e-9}) {
    const double back = 0.5 * std::erfc(-run::normal_quantile(share) / std::sqrt(2.0));
    EXPECT_NEAR(back / share, 1.0, 1e-12) << share;
  }
}

config::Node map_of(const std::string& yaml) {
  return config::load_text(yaml, "s.yaml");
}

double value_of(const std::string& yaml, double share) {
  return std::stod(run::Distribution::read(map_of(yaml))->value(share));
}

TEST(Distribution, EachSpansItsRange) {
  EXPECT_EQ(value_of("{uniform: [2, 4]}", 0.25), 2.5);
  EXPECT_NEAR(value_of("{log_uniform: [1, 100]}", 0.5), 10.0, 1e-14);
  EXPECT_EQ(value_of("{normal: [5, 2]}", 0.5), 5.0);
  EXPECT_NEAR(value_of("{normal: [5, 2]}", 0.975), 5.0 + 2.0 * 1.959963984540054, 1e-13);
  EXPECT_NEAR(value_of("{normal: [0, 1], between: [-1, 1]}", 1e-12), -1.0, 1e-9);
  EXPECT_NEAR(value_of("{normal: [0, 1], between: [-1, 1]}", 1.0 - 1e-12), 1.0, 1e-9);
  EXPECT_EQ(value_of("{integers: [1, 3]}", 0.32), 1.0);
  EXPECT_EQ(value_of("{integers: [1, 3]}", 0.34), 2.0);
  EXPECT_EQ(value_of("{integers: [1, 3]}", 1.0 - 1e-16), 3.0);
}

TEST(Distribution, SaysWhatIsWrong) {
  const auto fault = [](const std::string& yaml) {
    return refusal([&] { run::Distribution::read(map_of(yaml)); });
  };
  EXPECT_THAT(fault("{uniform: [2, 2]}"), HasSubstr("the first must be less than the second"));
  EXPECT_THAT(fault("{log_uniform: [0, 2]}"), HasSubstr("both must be greater than 0"));
  EXPECT_THAT(fault("{normal: [0, 0]}"), HasSubstr("standard deviation"));
  EXPECT_THAT(fault("{normal: [0, 1], between: [50, 60]}"), HasSubstr("less than a billionth"));
  EXPECT_THAT(fault("{integers: [0.5, 2]}"), HasSubstr("whole numbers"));
  EXPECT_THAT(fault("{uniform: [1, 2], step: 1}"), HasSubstr("unknown key 'step'"));
  EXPECT_FALSE(run::Distribution::read(map_of("{from: 1, to: 2}")));
}

run::Sampling sampling(const std::string& method, std::size_t runs, int seed = 1) {
  return *run::Sampling::read(map_of("sampling: {method: " + method + ", runs: " + std::to_string(runs) +
                                     ", seed: " + std::to_string(seed) + "}"));
}

// How many of `pieces` equal pieces of an axis are met.
std::size_t pieces_met(const run::Sampling& sampling, std::size_t axis, std::size_t runs) {
  std::set<std::size_t> met;
  for (std::size_t run = 1; run <= runs; ++run) {
    const double share = sampling.share(axis, run);
    EXPECT_GT(share, 0.0);
    EXPECT_LT(share, 1.0);
    met.insert(static_cast<std::size_t>(share * static_cast<double>(runs)));
  }
  return met.size();
}

TEST(Sampling, ALatinHypercubeMeetsEachPieceOnce) {
  for (const std::size_t runs : {1u, 2u, 3u, 10u, 1000u})
    for (const std::size_t axis : {0u, 5u, 15u})
      EXPECT_EQ(pieces_met(sampling("latin_hypercube", runs), axis, runs), runs) << runs << " " << axis;
}

TEST(Sampling, SobolsFirstPowersOfTwoMeetEachPieceOnce) {
  for (const std::size_t runs : {2u, 16u, 1024u})
    for (std::size_t axis = 0; axis < run::Sweep::kMaxAxes; ++axis)
      EXPECT_EQ(pieces_met(sampling("sobol", 100'000, 7), axis, runs), runs) << runs << " " << axis;
}

TEST(Sampling, RandomPointsAreSpreadAndTheirAxesAreApart) {
  const auto random = sampling("random", 10'000);
  double sum = 0.0, product = 0.0;
  for (std::size_t run = 1; run <= random.runs(); ++run) {
    sum += random.share(0, run);
    product += (random.share(0, run) - 0.5) * (random.share(1, run) - 0.5);
  }
  EXPECT_NEAR(sum / 1e4, 0.5, 0.012);  // 4 standard deviations
  EXPECT_NEAR(product / 1e4, 0.0, 0.0034);
}

TEST(Sampling, OtherSeedsAreOtherPoints) {
  for (const char* method : {"random", "latin_hypercube", "sobol"}) {
    EXPECT_EQ(sampling(method, 100).share(3, 42), sampling(method, 100).share(3, 42));
    EXPECT_NE(sampling(method, 100).share(3, 42), sampling(method, 100, 2).share(3, 42));
  }
}

TEST(Sampling, TheLastOfManyRunsIsFoundAtOnce) {
  const run::Sweep sweep(
      map_of("sweep: {a: {uniform: [0, 1]}, b: [x, y], c: {from: 1, to: 3}}\nsampling: {method: "
             "latin_hypercube, runs: 1000000000}"));
  EXPECT_EQ(sweep.runs(), 1'000'000'000u);
  EXPECT_EQ(sweep.point(1'000'000'000).described.size(), 3u);
}

TEST(Sampling, SaysWhatIsWrong) {
  const auto fault = [](const std::string& yaml) { return refusal([&] { run::Sweep(map_of(yaml)); }); };
  EXPECT_THAT(fault("sampling: {method: random, runs: 3}"), HasSubstr("needs a 'sweep'"));
  EXPECT_THAT(fault("sweep: {a: {uniform: [0, 1]}}"), HasSubstr("needs 'sampling'"));
  EXPECT_THAT(fault("sweep: {a: [1]}\nsampling: {method: sobl, runs: 3}"), HasSubstr("did you mean 'sobol'"));
  EXPECT_THAT(fault("sweep: {a: [1]}\nsampling: {method: sobol, runs: 0}"), HasSubstr("sampling.runs"));
}

// Against the worked example of Brown, Cai and DasGupta's tables: 8 of 10.
TEST(Wilson, IsTheIntervalOfTheLiterature) {
  EXPECT_NEAR(wilson(8, 10).low, 0.4901625, 1e-7);
  EXPECT_NEAR(wilson(8, 10).high, 0.9433178, 1e-7);
  EXPECT_EQ(wilson(0, 0).low, 0.0);
  EXPECT_EQ(wilson(0, 0).high, 1.0);
  EXPECT_EQ(wilson(10, 10).high, 1.0);
  EXPECT_EQ(wilson(0, 10).low, 0.0);
  EXPECT_NEAR(wilson(10, 10).low, 0.7224672, 1e-7);
}

constexpr run::Decide kClaim{0.99, 0.97, 0.05, 0.05};

std::size_t decided_after(SequentialTest& test, SequentialTest::Outcome outcome) {
  for (std::size_t i = 1; i <= 10'000; ++i) {
    test.take(outcome);
    if (test.decision() != Decision::kUndecided) return i;
  }
  return 0;
}

// Each run that passes adds ln(0.97/0.99), each that fails ln(0.03/0.01); the ends are -+ln(19).
TEST(SequentialTest, DecidesWhereWaldsBoundsAre) {
  SequentialTest good(kClaim), bad(kClaim), none(kClaim);
  EXPECT_EQ(decided_after(good, SequentialTest::Outcome::kPassed), 145u);
  EXPECT_EQ(good.decision(), Decision::kAccepted);
  EXPECT_EQ(decided_after(bad, SequentialTest::Outcome::kFailed), 3u);
  EXPECT_EQ(bad.decision(), Decision::kRejected);
  EXPECT_EQ(decided_after(none, SequentialTest::Outcome::kInvalid), 0u);
}

TEST(SequentialTest, AnInvalidRunHoldsTheAcceptanceBack) {
  SequentialTest test(kClaim);
  test.take(SequentialTest::Outcome::kInvalid);
  EXPECT_GT(decided_after(test, SequentialTest::Outcome::kPassed), 190u);
  EXPECT_EQ(test.decision(), Decision::kAccepted);
}

// Wrong verdicts among 2,000 campaigns: the risk is 5 %, and 8 % would be 6 standard deviations away.
TEST(SequentialTest, KeepsItsRisks) {
  const auto random = sampling("random", 10'000'000);
  std::size_t at = 0;
  const auto wrong = [&](double share, Decision verdict) {
    std::size_t count = 0;
    for (int campaign = 0; campaign < 2000; ++campaign) {
      SequentialTest test(kClaim);
      while (test.decision() == Decision::kUndecided)
        test.take(random.share(0, ++at) < share ? SequentialTest::Outcome::kPassed
                                                : SequentialTest::Outcome::kFailed);
      if (test.decision() == verdict) ++count;
    }
    return static_cast<double>(count) / 2000.0;
  };
  EXPECT_LT(wrong(0.99, Decision::kRejected), 0.08);
  EXPECT_LT(wrong(0.97, Decision::kAccepted), 0.08);
}

TEST(Decide, SaysWhatIsWrong) {
  const auto fault = [](const std::string& yaml) { return refusal([&] { run::read_decide(map_of(yaml)); }); };
  EXPECT_THAT(fault("decide: {at_least: 0.9, reject_below: 0.95}"),
              HasSubstr("must be less than 'at_least'"));
  EXPECT_THAT(fault("decide: {at_least: 1, reject_below: 0.95}"), HasSubstr("decide.at_least"));
  EXPECT_THAT(fault("decide: {at_least: 0.9}"), HasSubstr("reject_below"));
  EXPECT_THAT(fault("decide: 0.9"), HasSubstr("must be a map"));
}

}  // namespace
}  // namespace visum::campaign
