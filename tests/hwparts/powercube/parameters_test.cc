// The parameters: a module answers all that m5api knows with their type, and they agree with each other. A
// written value comes back, or it is refused.
#include <cmath>
#include <numbers>

#include "hwparts/powercube/parameters.h"
#include "tests/hwparts/powercube/bus_bench.h"

namespace visum::test {
namespace {

using powercube::ValueType;

// The types by parameter number, as m5api has them: f u i s w b, and d for the combined answer. '-': m5api
// has no such parameter.
struct Range {
  int first;
  const char* types;
};
constexpr Range kTypes[] = {
    {0x00, "ffffff-fffffffff"}, {0x10, "f--------uuuuw-w"},  {0x20, "b-bbiiuuiiiii---"},
    {0x30, "-----si--ubfffff"}, {0x40, "fff--ff-f-f-fffff"}, {0x51, "ssssssbufiiiiii"},
    {0x60, "iidffisiiw--ssss"}, {0x70, "ffffffffffiiiiii"},  {0x80, "ifi"},
};

char type_of(int id) {
  for (const auto& range : kTypes) {
    const std::string types = range.types;
    if (id >= range.first && id < range.first + static_cast<int>(types.size()))
      return types[static_cast<std::size_t>(id - range.first)];
  }
  return '-';
}

std::size_t size_of(char type) {
  switch (type) {
    case 'd':
      return 6;
    case 's':
    case 'w':
      return 2;
    case 'b':
      return 1;
    default:
      return 4;
  }
}

TEST(PowerCubeParameters, AllThatExistAreAnsweredWithTheirSizeAndNoOthers) {
  BusBench bench;  // firmware 0x4634 knows all
  for (int id = 0; id < 256; ++id) {
    const auto answer = bench.send(1, {0x0A, static_cast<std::uint8_t>(id)});
    const char type = type_of(id);
    ASSERT_EQ(answer.has_value(), type != '-') << std::hex << id;
    if (!answer) continue;
    EXPECT_EQ(answer->size, 2 + size_of(type)) << std::hex << id;
    EXPECT_EQ(answer->data[0], 0x0A);
    EXPECT_EQ(answer->data[1], id);
  }
}

TEST(PowerCubeParameters, OlderFirmwareKnowsFewer) {
  BusBench old("homed: false");
  for (const auto id : {0x70, 0x74, 0x80, 0x66, 0x6C})
    EXPECT_EQ(old.send(1, {0x0A, static_cast<std::uint8_t>(id)}), std::nullopt) << std::hex << id;
  for (const auto id : {0x58, 0x62, 0x63, 0x67})
    EXPECT_TRUE(old.send(1, {0x0A, static_cast<std::uint8_t>(id)}));
}

TEST(PowerCubeParameters, GatesAreThoseOfM5api) {
  using powercube::known_to;
  using powercube::Since;
  EXPECT_FALSE(known_to(Since::kCombined, 0x2517));
  EXPECT_TRUE(known_to(Since::kCombined, 0x2518));
  EXPECT_FALSE(known_to(Since::kCombined, 0x3500));
  EXPECT_TRUE(known_to(Since::kCombined, 0x3518));
  EXPECT_FALSE(known_to(Since::kSetup, 0x34FF));
  EXPECT_TRUE(known_to(Since::kExtended, 0x4601));
}

class EachModule : public testing::TestWithParam<int> {};

TEST_P(EachModule, IncrementsGearAndFloatAgree) {
  const int id = GetParam();
  BusBench bench("", 0.001, 0.37);
  bench.run(0.05);
  const double ratio = bench.get<float>(id, 0x3B);
  const double by_gear = bench.get<std::uint32_t>(id, 0x1C) * bench.get<float>(id, 0x01) /
                         (2.0 * std::numbers::pi * bench.get<float>(id, 0x02));
  EXPECT_NEAR(ratio, by_gear, 1e-6 * ratio);
  const double rounding = 1e-7 * ratio + 0.51;
  const std::pair<std::uint8_t, std::uint8_t> kPairs[] = {
      {0x3C, 0x5A}, {0x3F, 0x61}, {0x40, 0x5B}, {0x45, 0x5C}, {0x46, 0x5D}, {0x48, 0x5E},
      {0x4A, 0x5F}, {0x4F, 0x29}, {0x50, 0x2A}, {0x59, 0x2C}, {0x64, 0x65}};
  for (const auto& [number, increments] : kPairs)
    EXPECT_NEAR(bench.get<std::int32_t>(id, increments), bench.get<float>(id, number) * ratio,
                rounding + 4e-7 * ratio)
        << std::hex << int(number);
  EXPECT_NEAR(bench.position(id),
              bench.out(id < 8 ? "Actual Angle " + std::to_string(id) : "Actual Finger Position 1") *
                  (id < 8 ? 1.0 : 2.0),
              1e-6);
}

TEST_P(EachModule, FactoryValuesAreCopiesOfTheActualOnes) {
  const int id = GetParam();
  BusBench bench;
  const std::pair<std::uint8_t, std::uint8_t> kPairs[] = {{0x03, 0x45}, {0x04, 0x46}, {0x05, 0x40},
                                                          {0x0A, 0x48}, {0x0C, 0x4A}, {0x0E, 0x4C},
                                                          {0x00, 0x59}, {0x0F, 0x64}};
  for (const auto& [factory, actual] : kPairs)
    EXPECT_EQ(bench.get<float>(id, factory), bench.get<float>(id, actual)) << std::hex << int(factory);
  EXPECT_EQ(bench.get<std::uint32_t>(id, 0x1B), bench.get<std::uint32_t>(id, 0x39));
  EXPECT_EQ(bench.get<std::uint32_t>(id, 0x1B), id == 8 ? 0x20108u : 0x108u);
  EXPECT_EQ(bench.get<std::uint32_t>(id, 0x1A), 40000u + static_cast<unsigned>(id));
}
INSTANTIATE_TEST_SUITE_P(PowerCube, EachModule, testing::Range(1, 9), testing::PrintToStringParamName());

// The factory's values can be written back, and each written value comes back.
TEST(PowerCubeParameters, WhatIsReadCanBeWrittenBack) {
  BusBench bench;
  int written = 0;
  for (const auto& parameter : powercube::parameters()) {
    if (!parameter.set) continue;
    auto answer = bench.send(1, {0x0A, parameter.id});
    ASSERT_TRUE(answer);
    auto request = *answer;
    request.data[0] = 0x08;
    EXPECT_EQ(bench.send(1, request), (Message{0x08, parameter.id, 0x64})) << std::hex << int(parameter.id);
    const auto again = bench.send(1, {0x0A, parameter.id});
    if (parameter.type == ValueType::kFloat || parameter.type == ValueType::kInt32) {
      EXPECT_EQ(again->size, answer->size);  // a float is not the double that it was made of
    } else {
      EXPECT_EQ(again, answer) << std::hex << int(parameter.id);
    }
    ++written;
  }
  EXPECT_GE(written, 40);
}

TEST(PowerCubeParameters, ReadOnlyUnknownAndMisshapenOnesAreRefused) {
  BusBench bench;
  EXPECT_EQ(bench.send(1, with_value({0x08, 0x3C}, 1.0f)), (Message{0x08, 0x3C, 0x00}));
  EXPECT_EQ(bench.send(1, with_value({0x08, 0x11}, 1.0f)), (Message{0x08, 0x11, 0x00}));
  EXPECT_EQ(bench.send(1, {0x08, 0x48, 0x00}), (Message{0x08, 0x48, 0x00}));
  EXPECT_EQ(bench.send(1, {0x08}), std::nullopt);
  for (const auto& [id, value] :
       {std::pair<std::uint8_t, std::int16_t>{0x54, 13}, {0x54, 66}, {0x55, 0}, {0x55, 5}, {0x56, 13}})
    EXPECT_FALSE(bench.set(1, id, value)) << std::hex << int(id) << " " << value;
  EXPECT_FALSE(bench.set<std::uint8_t>(1, 0x20, 32));
  EXPECT_FALSE(bench.set<std::uint8_t>(1, 0x20, 0));
  EXPECT_FALSE(bench.set(1, 0x45, 3.2f));  // above the maximum
}

struct Gain {
  const char* name;
  std::uint8_t parameter;
  std::int16_t factory, softer;

  friend void PrintTo(const Gain& gain, std::ostream* out) { *out << gain.name; }
};

class EachGain : public testing::TestWithParam<Gain> {};

// The distance by which a sudden load moves module 1, rad.
double yielding(BusBench& bench) {
  double most = 0.0;
  bench.plants[0].external = 60.0;
  for (int i = 0; i < 500; ++i) {
    bench.tick();
    most = std::max(most, std::abs(double(bench.position(1))));
  }
  bench.plants[0].external = 0.0;
  bench.run(3.0);
  return most;
}

TEST_P(EachGain, ActsFromRecalcPidOn) {
  const auto [name, parameter, factory, softer] = GetParam();
  BusBench stiff, soft;
  EXPECT_TRUE(soft.set(1, parameter, softer));
  const double before = yielding(stiff);
  EXPECT_EQ(yielding(soft), before);  // not yet
  EXPECT_EQ(soft.send(1, {0x09}), Message{0x09});
  EXPECT_GT(yielding(soft), 1.05 * before);
  EXPECT_EQ(soft.get<std::int16_t>(1, parameter), softer);
  EXPECT_EQ(soft.get<std::int16_t>(1, parameter - 3), factory);
}
INSTANTIATE_TEST_SUITE_P(PowerCube, EachGain,
                         testing::Values(Gain{"C0", 0x54, 64, 12}, Gain{"Damp", 0x55, 4, 1},
                                         Gain{"A0", 0x56, 3, 1}),
                         [](const auto& info) { return std::string(info.param.name); });

TEST(PowerCubeParameters, TheLoopIsStableAtEveryCornerOfTheGains) {
  for (const std::int16_t c0 : {12, 64}) {
    for (const std::int16_t damp : {1, 4}) {
      for (const std::int16_t a0 : {1, 12}) {
        BusBench bench;
        EXPECT_TRUE(bench.set(1, 0x54, c0) && bench.set(1, 0x55, damp) && bench.set(1, 0x56, a0));
        bench.send(1, {0x09});
        bench.ramp(1, 0.2f);
        bench.run(4.0);
        EXPECT_NEAR(bench.position(1), 0.2, 1e-3) << c0 << " " << damp << " " << a0;
        EXPECT_NEAR(bench.get<float>(1, 0x41), 0.0, 1e-3) << c0 << " " << damp << " " << a0;
      }
    }
  }
}

TEST(PowerCubeParameters, SavingThemIsCounted) {
  BusBench bench;
  EXPECT_EQ(bench.send(1, {0x10}), Message{0x10});
  EXPECT_EQ(bench.get<std::uint8_t>(1, 0x57), 2);
}

TEST(PowerCubeParameters, WhatWouldChangeNothingIsRefused) {
  BusBench bench;
  EXPECT_FALSE(bench.set<std::int32_t>(1, 0x67, 100));  // load limit
  EXPECT_FALSE(bench.set<std::int32_t>(1, 0x68, 100));
  EXPECT_FALSE(bench.set<std::uint16_t>(1, 0x69, 100));
  EXPECT_FALSE(bench.set<std::int16_t>(1, 0x66, 1));
  EXPECT_FALSE(bench.set(1, 0x77, 48.0f));
  EXPECT_EQ(bench.get<std::int32_t>(1, 0x67), 0);
}

// GT's client masks the top nibble of Config and sets 0x80000.
TEST(PowerCubeParameters, ConfigIsAcceptedWholeButALinearModuleStaysLinear) {
  BusBench bench;
  EXPECT_TRUE(bench.set<std::uint32_t>(1, 0x39, (0x108u | 0x80000u) & 0x0FFFFFFFu));
  EXPECT_EQ(bench.get<std::uint32_t>(1, 0x39), 0x80108u);
  EXPECT_TRUE(bench.set<std::uint32_t>(8, 0x39, 0x108u));
  EXPECT_EQ(bench.get<std::uint32_t>(8, 0x39), 0x20108u);
}

TEST(PowerCubeParameters, LimitsAreThoseOfThePorts) {
  BusBench bench;
  EXPECT_TRUE(bench.set(1, 0x46, 0.4f));
  const auto parameters = bench.part->parameters();
  const auto found = std::ranges::find(parameters, "Soft Limit Maximum 1", &protocol::Parameter::name);
  ASSERT_NE(found, parameters.end());
  EXPECT_NEAR(std::get<double>(found->value), 0.4, 1e-6);
  bench.in("Desired Angle 1") = 1.0;
  bench.run(4.0);
  EXPECT_TRUE(bench.word(1) & bit::kBeyondSoft);
  EXPECT_NEAR(bench.position(1), 0.4, 2e-3);
}

// The limits mean homed positions, wherever the module counts from before homing.
TEST(PowerCubeParameters, LimitsThatAreSetBeforeHomingAreTheSameAfterIt) {
  BusBench bench("homed: false, modules: {counts_from_zero: true}", 0.001, 0.5);
  const float least = bench.get<float>(1, 0x03), most = bench.get<float>(1, 0x04);
  EXPECT_TRUE(bench.set(1, 0x45, -1.0f) && bench.set(1, 0x46, 1.0f));
  EXPECT_TRUE(bench.set(1, 0x45, least) && bench.set(1, 0x46, most));
  EXPECT_EQ(bench.get<float>(1, 0x45), least);
  EXPECT_EQ(bench.get<float>(1, 0x46), most);
  bench.set(1, 0x46, 6.0f);
  const float highest = bench.get<float>(1, 0x46);
  bench.send(1, {0x01});
  ASSERT_TRUE(bench.wait_for(1, bit::kHomeOk, 10.0));
  bench.set(1, 0x46, 6.0f);
  EXPECT_EQ(bench.get<float>(1, 0x46), highest);
}

TEST(PowerCubeParameters, OutputsAndSwitchesAreInTheDigitalWord) {
  BusBench bench("modules: {config: 0x00004908}");
  EXPECT_TRUE(bench.set<std::uint32_t>(1, 0x26, 0xFF));
  EXPECT_EQ(bench.get<std::uint32_t>(1, 0x26), 0xF0u);
  bench.plants[0].joint.position = -0.01;
  bench.part->reset();
  bench.run(0.05);
  BusBench below("", 0.001, -0.01);
  below.run(0.05);
  EXPECT_TRUE(below.word(1) & bit::kSwr);
  EXPECT_EQ(below.get<std::uint32_t>(1, 0x26), 0x100u);
  EXPECT_EQ(below.send(1, {0x0A, 0x62})->data[6], 0x22);
}

struct BadSettings {
  const char* name;
  const char* modules;
  const char* key;
};

class WrongSettings : public testing::TestWithParam<BadSettings> {};

TEST_P(WrongSettings, NameTheKey) {
  try {
    BusBench bench(std::string("modules: ") + GetParam().modules);
    FAIL() << "accepted";
  } catch (const config::ConfigError& error) {
    EXPECT_NE(std::string(error.what()).find(GetParam().key), std::string::npos) << error.what();
  }
}
INSTANTIATE_TEST_SUITE_P(PowerCube, WrongSettings,
                         testing::Values(BadSettings{"Key", "{watchdog: 1}", "watchdog"},
                                         BadSettings{"Firmware", "{firmware: 0x1234}", "firmware"},
                                         BadSettings{"Word", "{config: 0x1FFFFFFFF}", "config"},
                                         BadSettings{"NoHex", "{config: 0x}", "config"},
                                         BadSettings{"Choice", "{beyond_limits: ignore}", "beyond_limits"},
                                         BadSettings{"Module", "{each: {9: {}}}", "no module 9"},
                                         BadSettings{"Nested", "{each: {8: {each: {}}}}", "each"},
                                         BadSettings{"Time", "{watchdog_s: 0}", "watchdog_s"}),
                         [](const auto& info) { return std::string(info.param.name); });

}  // namespace
}  // namespace visum::test
