// Addresses of buses on the command line and in a scene; error messages name the mistake.
#include "server/bus/address.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "tests/bus/bus_line.h"

namespace visum::bus {
namespace {

scene::Scene arm() {
  return scene::load_scene(VISUM_SOURCE_DIR "/models/scenes/amtec_arm.yaml");
}

TEST(BusAddress, TellsPartKindPlaceAndTiming) {
  const auto address = parse_bus("arm=pty:/tmp/arm=1.tty,baud=38400,delay_ms=0.5", arm());
  EXPECT_EQ(address.part, "arm");
  EXPECT_EQ(address.kind, "pty");
  EXPECT_EQ(address.where, "/tmp/arm=1.tty");
  EXPECT_EQ(address.timing.baud, 38400.0);
  EXPECT_EQ(address.timing.delay_ns, 500'000);
  EXPECT_TRUE(parse_bus("arm=tcp:0", arm()).timing.ideal());
}

struct Wrong {
  const char* name;
  const char* text;
  const char* says;
};
class WrongAddress : public testing::TestWithParam<Wrong> {};

TEST_P(WrongAddress, IsRefusedWithTheReason) {
  try {
    parse_bus(GetParam().text, arm());
    FAIL() << "accepted";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr(GetParam().says));
  }
}
INSTANTIATE_TEST_SUITE_P(Bus, WrongAddress,
                         testing::Values(Wrong{"NoPart", "pty:arm.tty", "PART="},
                                         Wrong{"OtherPart", "amr=pty:x", "did you mean 'arm'"},
                                         Wrong{"NoKind", "arm=arm.tty", "pty, tcp, slcan, socketcan"},
                                         Wrong{"OtherKind", "arm=usb:0", "pty, tcp, slcan, socketcan"},
                                         Wrong{"NoPlace", "arm=pty:", "behind the colon"},
                                         Wrong{"Option", "arm=pty:x,speed=3", "baud=N and delay_ms=X"},
                                         Wrong{"Number", "arm=pty:x,baud=fast", "between"},
                                         Wrong{"Range", "arm=pty:x,baud=3", "between"}),
                         [](const auto& info) { return std::string(info.param.name); });

// A small scene with `bus: ...` in its part.
scene::Scene scene_with(const LinkFolder& folder, const std::string& bus) {
  const std::string models = VISUM_SOURCE_DIR "/models/";
  std::ofstream(folder / "scene.yaml")
      << "visum: 1\n"
      << "models: [{name: m, file: " << models << "two_link/two_link.urdf}]\n"
      << "parts:\n"
      << "  - {name: links, kind: servo_group, model: m, drives: " << models << "two_link/drives.yaml,\n"
      << "     bus: " << bus << "}\n";
  return scene::load_scene(folder / "scene.yaml");
}

TEST(BusAddress, ASceneSaysTheSame) {
  LinkFolder folder;
  const auto buses = scene_buses(scene_with(folder, "[pty:arm.tty, \"tcp:0,baud=9600\"]"));
  ASSERT_EQ(buses.size(), 2u);
  EXPECT_EQ(buses[0].part, "links");
  EXPECT_EQ(buses[0].kind, "pty");
  EXPECT_EQ(buses[1].timing.baud, 9600.0);
  EXPECT_EQ(scene_buses(scene_with(folder, "slcan:x")).size(), 1u);
  EXPECT_TRUE(scene_buses(arm()).empty());
}

TEST(BusAddress, AMistakeInASceneNamesFileLineAndKey) {
  LinkFolder folder;
  try {
    scene_buses(scene_with(folder, "[pty:arm.tty, usb:0]"));
    FAIL() << "accepted";
  } catch (const config::ConfigError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("scene.yaml:5: parts[0].bus[1]"));
  }
}

}  // namespace
}  // namespace visum::bus
