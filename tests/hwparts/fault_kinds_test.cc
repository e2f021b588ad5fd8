// The table of faults, and the refusals of wrong kinds and numbers.
#include "hwparts/fault_kinds.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "hwparts/fault_set.h"

namespace visum::hwparts {
namespace {

std::string refusal(const std::string& kind, const NamedNumbers& numbers) {
  std::string why;
  return make_fault(kind, numbers, why) ? "taken" : why;
}

TEST(FaultKinds, StandInTheOrderOfTheirNumbersAndHaveNamesOfTheirOwn) {
  std::set<std::string> names;
  for (std::size_t i = 0; i < fault_kinds().size(); ++i) {
    const auto& info = fault_kinds()[i];
    EXPECT_EQ(static_cast<std::size_t>(info.kind), i) << info.name;
    EXPECT_TRUE(names.insert(info.name).second) << info.name;
    EXPECT_FALSE(std::string(info.effect).empty()) << info.name;
    EXPECT_EQ(info.target == FaultTarget::kDrive,
              info.numbers[0] && std::string(info.numbers[0]->name) == "joint")
        << info.name;
  }
}

TEST(FaultKinds, TakeTheirNumbersByName) {
  std::string why;
  const auto fault = make_fault("torque_lost", {{"share", 0.25}, {"joint", 3}}, why);
  ASSERT_TRUE(fault) << why;
  EXPECT_EQ(fault->drive(), 2u);
  EXPECT_EQ(fault->numbers[1], 0.25);
  EXPECT_EQ(make_fault("torque_lost", {{"joint", 3}}, why)->numbers[1], 1.0)
      << "all of it, unless said otherwise";
}

TEST(FaultKinds, RefuseWhatTheyDoNotMeanWithTheReason) {
  EXPECT_EQ(refusal("encoder_stuk", {}), "there is no fault 'encoder_stuk'; did you mean 'encoder_stuck'?");
  EXPECT_EQ(refusal("rust", {}), "there is no fault 'rust'; `visum faults` lists them");
  EXPECT_EQ(refusal("encoder_stuck", {}), "'encoder_stuck' needs the number 'joint'");
  EXPECT_EQ(refusal("encoder_stuck", {{"join", 1}}),
            "'encoder_stuck' has no number 'join'; it has joint; did you mean 'joint'?");
  EXPECT_EQ(refusal("emergency_stop", {{"joint", 1}}), "'emergency_stop' has no number 'joint'; it has none");
  EXPECT_EQ(refusal("encoder_stuck", {{"joint", 1}, {"joint", 2}}), "'joint' is given twice");
  EXPECT_EQ(refusal("encoder_stuck", {{"joint", 1.5}}), "'joint' is the number of a drive, from 1");
  EXPECT_EQ(refusal("torque_lost", {{"joint", 1}, {"share", 1.5}}), "'share' must be within 0 and 1, is 1.5");
  EXPECT_EQ(refusal("torque_lost", {{"joint", 1}, {"share", NAN}}), "'share' must be a finite number");
}

ActiveFault stuck(std::uint32_t part, double joint, std::int64_t until = 0) {
  return {part, {FaultKind::kEncoderStuck, {joint}}, until};
}

TEST(FaultSet, KeepsThePartsTogetherAndReplacesWhatIsThere) {
  FaultSet set;
  for (const auto& fault : {stuck(1, 1), stuck(0, 2), stuck(1, 2), stuck(0, 1)})
    EXPECT_TRUE(set.inject(fault));
  EXPECT_TRUE(set.inject(stuck(1, 1, 50)));
  ASSERT_EQ(set.all().size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(set.all()[i].part, i / 2);
  EXPECT_FALSE(set.expire(49));
  EXPECT_TRUE(set.expire(50));
  EXPECT_EQ(set.all().size(), 3u);
  EXPECT_EQ(set.clear(0, FaultKind::kEncoderStuck, 0), 1u) << "of its first drive";
  EXPECT_EQ(set.clear(0, FaultKind::kGearSlip, {}), 0u);
  EXPECT_EQ(set.clear(0, {}, {}), 1u);
}

TEST(FaultSet, ReadsBackWhatItSaved) {
  FaultSet set, other;
  set.inject(stuck(3, 2, 77));
  std::vector<std::byte> bytes;
  {
    StateWriter to(bytes);
    set.save(to);
  }
  StateReader from(bytes);
  other.load(from, 4);
  ASSERT_EQ(other.all().size(), 1u);
  EXPECT_EQ(other.all()[0].part, 3u);
  EXPECT_EQ(other.all()[0].fault.drive(), 1u);
  EXPECT_EQ(other.all()[0].until_tick, 77);
  EXPECT_TRUE(from.at_end());
}

// A saved state may come from a file, so load() checks it.
TEST(FaultSet, BelievesNoPartAndNoNumber) {
  const auto load = [](const ActiveFault& fault) {
    std::vector<std::byte> bytes;
    StateWriter to(bytes);
    to.put(std::uint64_t{1}), to.put(fault.part), to.put(fault.fault.kind), to.put(fault.until_tick);
    to.put(std::span<const double>(fault.fault.numbers));
    StateReader from(bytes);
    FaultSet().load(from, 2);
  };
  EXPECT_NO_THROW(load(stuck(1, 3)));
  EXPECT_THROW(load(stuck(2, 3)), std::out_of_range) << "there are two parts";
  EXPECT_THROW(load(stuck(1, 1e300)), std::out_of_range);
  EXPECT_THROW(load(stuck(1, 0)), std::out_of_range);
  EXPECT_THROW(load({0, {FaultKind::kNetworkDelay, {1e18, 0}}, 0}), std::out_of_range);
  EXPECT_THROW(load({0, {FaultKind::kNetworkLoss, {NAN}}, 0}), std::out_of_range);
}

}  // namespace
}  // namespace visum::hwparts
