// The order of elimination, and the entries that it makes.
#include "server/dynamics/impulse/elimination.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>
#include <utility>
#include <vector>

namespace visum::dynamics::impulse {
namespace {

using Pair = std::pair<std::size_t, std::size_t>;

Elimination found(std::size_t count, const std::vector<Pair>& pairs) {
  Elimination elimination;
  elimination.start(count);
  for (const auto& [a, b] : pairs) elimination.connect(a, b);
  EXPECT_TRUE(elimination.find(100'000));
  return elimination;
}

// Entries below the diagonal, by elimination on a full matrix of what is not zero.
std::set<Pair> entries_by_hand(const Elimination& of, const std::vector<Pair>& pairs) {
  std::vector<std::vector<bool>> full(of.count(), std::vector<bool>(of.count()));
  for (const auto& [a, b] : pairs)
    full[of.position(a)][of.position(b)] = full[of.position(b)][of.position(a)] = true;
  std::set<Pair> entries;
  for (std::size_t k = 0; k < of.count(); ++k)
    for (std::size_t i = k + 1; i < of.count(); ++i) {
      if (!full[i][k]) continue;
      entries.insert({i, k});
      for (std::size_t j = k + 1; j < of.count(); ++j)
        if (full[j][k]) full[i][j] = true;
    }
  return entries;
}

void expect_sound(const Elimination& of, const std::vector<Pair>& pairs) {
  std::vector<std::size_t> order(of.order().begin(), of.order().end());
  for (std::size_t k = 0; k < order.size(); ++k) EXPECT_EQ(of.position(order[k]), k);
  std::ranges::sort(order);
  for (std::size_t i = 0; i < order.size(); ++i) EXPECT_EQ(order[i], i);
  std::set<Pair> entries;
  for (std::size_t k = 0; k < of.count(); ++k)
    for (std::size_t e = of.begins()[k]; e < of.begins()[k + 1]; ++e) {
      EXPECT_EQ(of.entry(of.rows()[e], k), e);
      entries.insert({of.rows()[e], k});
    }
  EXPECT_EQ(entries.size(), of.entries());
  EXPECT_EQ(entries, entries_by_hand(of, pairs));
}

TEST(Elimination, FillsNothingInAStarWhoseHubComesFirst) {
  std::vector<Pair> star;
  for (std::size_t i = 1; i < 70; ++i) star.emplace_back(0, i);
  const Elimination of = found(70, star);
  EXPECT_EQ(of.entries(), 69u);
  EXPECT_GE(of.position(0), 68u);  // with one leaf left, both hang on one
  expect_sound(of, star);
}

TEST(Elimination, FillsNothingInAChainOfAnyNumbering) {
  const std::vector<std::size_t> numbers{4, 0, 7, 2, 6, 1, 5, 3};
  std::vector<Pair> chain;
  for (std::size_t i = 0; i + 1 < numbers.size(); ++i) chain.emplace_back(numbers[i], numbers[i + 1]);
  const Elimination of = found(numbers.size(), chain);
  EXPECT_EQ(of.entries(), 7u);
  expect_sound(of, chain);
}

TEST(Elimination, HasTheEntriesThatEliminationMakes) {
  std::mt19937 generator(5);
  for (const std::size_t count : {1, 2, 9, 63, 64, 65, 130}) {
    std::vector<Pair> pairs;
    std::uniform_int_distribution<std::size_t> any(0, count - 1);
    for (std::size_t i = 0; i < 2 * count; ++i) {
      const std::size_t a = any(generator), b = any(generator);
      if (a != b) pairs.emplace_back(a, b);
    }
    expect_sound(found(count, pairs), pairs);
  }
}

TEST(Elimination, CountsTheProductsOfAFactor) {
  // A triangle: two entries, then one. Each makes one product with its inverse, and one for each target.
  const std::vector<Pair> triangle{{0, 1}, {1, 2}, {2, 0}};
  EXPECT_EQ(found(3, triangle).products(true), 2u + 3u + 1u + 1u);
  EXPECT_EQ(found(3, triangle).products(false), 2u + 4u + 1u + 1u);
}

TEST(Elimination, RefusesMoreEntriesThanItMayHave) {
  Elimination of = found(3, {{0, 1}, {1, 2}, {2, 0}});
  EXPECT_FALSE(of.find(2));
  EXPECT_FALSE(of.find(2)) << "nor from what it has kept";
  EXPECT_TRUE(of.find(3));
  EXPECT_EQ(of.entries(), 3u);
}

TEST(Elimination, FollowsFromTheLastPairsAlone) {
  const std::vector<Pair> square{{0, 1}, {1, 2}, {2, 3}, {3, 0}}, path{{3, 1}, {1, 0}};
  Elimination of = found(4, square);
  for (const auto& [count, pairs] :
       {std::pair{std::size_t{5}, path}, {std::size_t{4}, path}, {std::size_t{4}, square}}) {
    of.start(count);
    for (const auto& [a, b] : pairs) of.connect(a, b);
    EXPECT_TRUE(of.find(100'000));
    const Elimination anew = found(count, pairs);
    EXPECT_TRUE(std::ranges::equal(of.order(), anew.order()));
    EXPECT_TRUE(std::ranges::equal(of.rows(), anew.rows()));
    expect_sound(of, pairs);
  }
}

}  // namespace
}  // namespace visum::dynamics::impulse
