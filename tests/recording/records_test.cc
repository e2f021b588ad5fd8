// The messages of a recording: decoding returns what was encoded, and refuses other bytes.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "protocol/recording/loaded_scene.h"
#include "protocol/recording/records.h"

namespace visum::recording {
namespace {

// Encodes an input and decodes it again. `message` keeps the bytes that the result refers to.
const TimedInput& through(const Input& input, InputMessage& message) {
  std::vector<std::byte> bytes;
  encode(TimedInput{1234, 5, input}, bytes);
  EXPECT_TRUE(message.decode(bytes));
  EXPECT_EQ(message.input.tick, 1234);
  EXPECT_EQ(message.input.era, 5u);
  EXPECT_EQ(message.input.input.index(), input.index());
  return message.input;
}

TEST(Records, StatesComeBackAsTheyWere) {
  const auto some = bytes_of("12345678");
  const State state{
      77,
      3,
      9,
      5,
      {some.begin(), some.end()},
      {{4, {some.begin(), some.end()}}},
      {{State::Edit::Kind::kBodyCame, "{}", nullptr}, {State::Edit::Kind::kBodyWent, "x", nullptr}}};
  std::vector<std::byte> bytes;
  encode(state, bytes);
  State back;
  ASSERT_TRUE(decode(bytes, back));
  EXPECT_EQ(back.tick, 77);
  EXPECT_EQ(back.era, 3u);
  EXPECT_EQ(back.revision, 9u);
  EXPECT_EQ(back.next_snapshot, 5u);
  EXPECT_EQ(back.state, state.state);
  ASSERT_EQ(back.snapshots.size(), 1u);
  EXPECT_EQ(back.snapshots[0].number, 4u);
  EXPECT_EQ(back.snapshots[0].state, state.state);
  EXPECT_EQ(back.edits, state.edits);
}

TEST(Records, InputsComeBackAsTheyWere) {
  InputMessage message;
  const std::vector values{0.1, -0.0, 1e-310};
  const auto write = std::get<WriteInputs>(through(WriteInputs{"arm", 7, values}, message).input);
  EXPECT_EQ(write.part, "arm");
  EXPECT_EQ(write.first_port, 7u);
  EXPECT_EQ((std::vector<double>{write.values.begin(), write.values.end()}), values);
  EXPECT_TRUE(std::signbit(write.values[1])) << "to the bit";

  EXPECT_EQ(std::get<LoseController>(through(LoseController{"arm"}, message).input).part, "arm");
  const auto set = std::get<SetParameter>(
      through(SetParameter{"arm", "Gain", protocol::ParameterValue(std::string("high"))}, message).input);
  EXPECT_EQ(set.name, "Gain");
  EXPECT_EQ(std::get<std::string>(set.value), "high");

  const auto board = std::get<WriteBlackboard>(
      through(WriteBlackboard{"arm", "notes", 3, bytes_of("hello")}, message).input);
  EXPECT_EQ(board.offset, 3u);
  EXPECT_EQ(board.data.size(), 5u);
  const auto telegram =
      std::get<BusTelegram>(through(BusTelegram{"arm", 1, 2, 31, bytes_of("12345678")}, message).input);
  EXPECT_EQ(telegram.wire, 1);
  EXPECT_EQ(telegram.kind, 2);
  EXPECT_EQ(telegram.module, 31);
  EXPECT_EQ(telegram.data.size(), 8u);

  const auto push = std::get<PushBody>(through(PushBody{3, {1, 2, 3}, {4, 5, 6}, 99}, message).input);
  EXPECT_EQ(push.body, 3);
  EXPECT_EQ(push.force_n, (std::array<double, 3>{1, 2, 3}));
  EXPECT_EQ(push.torque_nm, (std::array<double, 3>{4, 5, 6}));
  EXPECT_EQ(push.until_tick, 99);

  const auto placed = std::get<SetBody>(
      through(SetBody{2, true, {1, 2, 3, 1, 0, 0, 0}, {4, 5, 6}, {7, 8, 9}}, message).input);
  EXPECT_EQ(placed.body, 2);
  EXPECT_TRUE(placed.moves);
  EXPECT_EQ(placed.pose, (std::array<double, 7>{1, 2, 3, 1, 0, 0, 0}));
  EXPECT_EQ(placed.turn_rate, (std::array<double, 3>{7, 8, 9}));
  EXPECT_FALSE(std::get<SetBody>(through(SetBody{2}, message).input).moves);
  const std::vector<std::int32_t> numbers{3, 1};
  const std::vector<double> positions{0.5, 1.5}, velocities{0.0, -2.0};
  const auto joints = std::get<SetJoints>(through(SetJoints{numbers, positions, velocities}, message).input);
  EXPECT_EQ((std::vector<std::int32_t>{joints.joints.begin(), joints.joints.end()}), numbers);
  EXPECT_EQ((std::vector<double>{joints.velocities.begin(), joints.velocities.end()}), velocities);
  const auto pull = std::get<PullBody>(through(PullBody{4, {1, 0, 0}, {0, 2, 0}, 3.5, 17}, message).input);
  EXPECT_EQ(pull.target, (std::array<double, 3>{0, 2, 0}));
  EXPECT_EQ(pull.max_force_n, 3.5);
  EXPECT_EQ(pull.until_tick, 17);
  EXPECT_EQ(std::get<ReleaseBody>(through(ReleaseBody{4}, message).input).body, 4);
  const auto scope = std::get<Reset>(through(Reset{protocol::ResetScope::kSpawned}, message).input).scope;
  EXPECT_EQ(scope, protocol::ResetScope::kSpawned);
  State kept;
  kept.tick = 12;
  kept.edits = {{State::Edit::Kind::kBodyCame, "{name: x}", nullptr},
                {State::Edit::Kind::kBodyWent, "y", nullptr}};
  const auto* restored = std::get<RestoreState>(through(RestoreState{&kept}, message).input).state;
  EXPECT_EQ(restored->tick, 12);
  EXPECT_EQ(restored->edits, kept.edits);
  EXPECT_EQ(std::get<TakeSnapshot>(through(TakeSnapshot{8}, message).input).number, 8u);
  EXPECT_EQ(std::get<RestoreSnapshot>(through(RestoreSnapshot{9}, message).input).number, 9u);
  EXPECT_EQ(std::get<AddBody>(through(AddBody{"{name: x}"}, message).input).yaml, "{name: x}");
  EXPECT_EQ(std::get<RemoveBody>(through(RemoveBody{"x"}, message).input).name, "x");

  const auto fault =
      std::get<InjectFault>(through(InjectFault{"arm", "gear_slip", values, 77}, message).input);
  EXPECT_EQ(fault.part, "arm");
  EXPECT_EQ(fault.kind, "gear_slip");
  EXPECT_EQ((std::vector<double>{fault.numbers.begin(), fault.numbers.end()}), values);
  EXPECT_EQ(fault.until_tick, 77);
  const auto clear = std::get<ClearFault>(through(ClearFault{"arm", "bus_late", 3}, message).input);
  EXPECT_EQ(clear.part, "arm");
  EXPECT_EQ(clear.kind, "bus_late");
  EXPECT_EQ(clear.drive, 3u);
}

TEST(Records, ALoadedSceneComesBackWithItsFiles) {
  InputMessage message;
  const LoadedScene cart{"cart",
                         "/s/cart.yaml",
                         "ode",
                         "{mass: 2}",
                         77,
                         {{"robot", "/r"}},
                         {"/ros/share"},
                         {{"/s/cart.yaml", "visum: 1"}, {"/s/cart.urdf", "<robot/>"}}};
  const auto loaded =
      std::get<LoadScene>(through(LoadScene{std::make_shared<const LoadedScene>(cart)}, message).input);
  EXPECT_EQ(*loaded.scene, cart);
}

TEST(Records, BytesThatAreNoInputAreRefused) {
  InputMessage message;
  EXPECT_FALSE(message.decode({})) << "an input of no kind";
  EXPECT_FALSE(message.decode(bytes_of("\xFF\xFF\xFF")));
  std::vector<std::byte> bytes;
  encode(TimedInput{0, 1, BusTelegram{"arm", 0, 4, 1, {}}}, bytes);
  EXPECT_FALSE(message.decode(bytes)) << "hosts send no state";
  bytes.clear();
  encode(TimedInput{0, 1, LoadScene{std::make_shared<const LoadedScene>()}}, bytes);
  EXPECT_FALSE(message.decode(bytes)) << "the file of the scene is not there";
  bytes.clear();
  encode(TimedInput{0, 1, BusTelegram{"arm", 0, 0, 1, bytes_of("123456789")}}, bytes);
  EXPECT_FALSE(message.decode(bytes)) << "nine bytes";
}

// Samples are encoded without the library's message, which reads them here.
TEST(Records, SamplesComeBackAsTheyWere) {
  const std::vector<double> some{0.1, -0.0, 1e-310, std::numeric_limits<double>::infinity()}, none;
  const std::vector<double> many(200, 0.25);  // their length takes two bytes
  const Sample samples[] = {{"arm", 1234, 1'234'000'000, 5, some, many},
                            {"a part with a longer name", -1, -1'000'000, 1, many, none},
                            {"", 0, 0, 0, none, some}};
  for (const auto& sample : samples) {
    std::vector<std::byte> bytes(3);
    encode(sample, bytes);
    protocol::PartSample back;
    ASSERT_TRUE(decode(Bytes(bytes).subspan(3), back)) << "appended";
    EXPECT_EQ(back.part, sample.part);
    EXPECT_EQ(back.tick, sample.tick);
    EXPECT_EQ(back.sim_time_ns, sample.sim_time_ns);
    EXPECT_EQ(back.era, sample.era);
    const auto expect_bits = [](const std::vector<double>& read, std::span<const double> written) {
      ASSERT_EQ(read.size(), written.size());
      EXPECT_TRUE(read.empty() || std::memcmp(read.data(), written.data(), written.size_bytes()) == 0);
    };
    expect_bits(back.controller_inputs, sample.controller_inputs);
    expect_bits(back.sensor_outputs, sample.sensor_outputs);
  }
}

TEST(Records, EachMessageHasItsSchema) {
  for (const auto name : {kHeaderSchema, kInputSchema, kTickSchema, kStateSchema, kLogSchema, kSampleSchema,
                          kDescriptionSchema}) {
    const auto data = schema(name);
    const std::string_view text(reinterpret_cast<const char*>(data.data()), data.size());
    const auto message = name.substr(name.rfind('.') + 1);
    EXPECT_NE(text.find(message), std::string_view::npos) << name;
    EXPECT_EQ(text.find("LoadScene") != std::string_view::npos, name == kInputSchema || name == kStateSchema)
        << name << ": no more than what it refers to";
  }
  EXPECT_THROW(schema("visum.v1.Nothing"), std::invalid_argument);
}

TEST(Records, TheHeaderAndTheTickComeBack) {
  std::vector<std::byte> bytes;
  Header header{kFormat,       "/a/s.yaml", "s",       "ode",
                "free",        42,          1'000'000, {"1", "abc", "gcc", "x86-64", {"ode"}},
                {{"f", 7, 9}}, "{mass: 2}"};
  encode(header, bytes);
  Header back;
  ASSERT_TRUE(decode(bytes, back));
  EXPECT_EQ(back.scene_file, "/a/s.yaml");
  EXPECT_EQ(back.seed, 42u);
  EXPECT_EQ(back.build, header.build);
  ASSERT_EQ(back.files.size(), 1u);
  EXPECT_EQ(back.files[0].crc, 9u);
  EXPECT_EQ(back.parameters, "{mass: 2}");

  bytes.clear();
  encode(Tick{3, 1, 3'000'000, 0xFEDCBA9876543210u, "arm/link_3 flies away"}, bytes);
  TickMessage tick;
  ASSERT_TRUE(tick.decode(bytes));
  EXPECT_EQ(tick.tick.state_hash, 0xFEDCBA9876543210u);
  EXPECT_EQ(tick.tick.fault, "arm/link_3 flies away");
}

}  // namespace
}  // namespace visum::recording
