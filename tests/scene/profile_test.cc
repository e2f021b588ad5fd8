// A Profile gives each moment to one phase.
#include "protocol/config/profile.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

namespace visum::config {
namespace {

std::int64_t sum_of(const std::vector<Profile::Time>& times) {
  std::int64_t sum = 0;
  for (const auto& time : times) sum += time.ns;
  return sum;
}

const Profile::Time* find(const std::vector<Profile::Time>& times, std::string_view name) {
  for (const auto& time : times)
    if (time.name == name) return &time;
  return nullptr;
}

TEST(Profile, PhasesOfTheRunAddUpToTheTimeBetweenItsTicks) {
  Profile profile(0);
  profile.enter(Profile::kGateway);
  for (int tick = 0; tick < 3; ++tick) {
    profile.tick_begins();
    {
      const ProfileScope physics(&profile, Profile::kPhysics);
      const ProfileScope hash(&profile, Profile::kHash);
    }
    profile.tick_ended();
  }
  profile.enter(Profile::kEnd);
  EXPECT_EQ(profile.ticks(), 3);
  EXPECT_EQ(sum_of(profile.run()), profile.last_tick_ns() - profile.first_tick_ns());
  ASSERT_NE(find(profile.run(), "physics"), nullptr);
  EXPECT_EQ(find(profile.run(), "physics")->times, 6);  // and again after each hash
  EXPECT_EQ(find(profile.run(), "load"), nullptr);
  EXPECT_NE(find(profile.whole(), "load"), nullptr);
}

TEST(Profile, AScopeGoesBackToThePhaseBefore) {
  Profile profile(0);
  profile.enter(Profile::kGateway);
  { const ProfileScope waits(&profile, profile.add("waits for arm")); }
  EXPECT_EQ(profile.enter(Profile::kEnd), Profile::kGateway);
  const ProfileScope nothing(nullptr, Profile::kWait);  // nobody measures
}

TEST(Profile, KnowsANameOnceAndHasABoundedNumberOfThem) {
  Profile profile(0);
  const auto first = profile.add("waits for arm");
  EXPECT_EQ(profile.add("waits for arm"), first);
  for (int i = 0; i < 100; ++i) profile.add("waits for " + std::to_string(i));
  EXPECT_EQ(profile.add("one more"), Profile::kWait);
  EXPECT_EQ(profile.add("hash"), Profile::kHash);
}

TEST(Profile, KeepsNoMoreSpansThanItMayAndSaysHowManyItLeftOut) {
  Profile profile(3);
  for (int i = 0; i < 5; ++i) {
    profile.enter(Profile::kWait);
    profile.enter(Profile::kGateway);
  }
  EXPECT_EQ(profile.left_out(), 8u);  // of eleven, the first of which is the load
  std::ostringstream out;
  profile.write_spans(out, 7);
  const auto text = out.str();
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 2);  // the end of the third is not known
}

TEST(Profile, ANameThatWouldBreakTheJsonDoesNot) {
  Profile profile(10);
  profile.enter(profile.add("waits for \"\\\n"));
  profile.enter(Profile::kEnd);
  std::ostringstream out;
  profile.write_spans(out, 7);
  EXPECT_NE(out.str().find("\"waits for ___\""), std::string::npos) << out.str();
}

}  // namespace
}  // namespace visum::config
