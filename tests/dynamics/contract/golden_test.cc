// The state's hash after a second of the busy scene, for each engine and step setting. GCC and Clang, debug
// and optimised, must give the same hash. A hash that changes needs a line in the changelog that says why.
// The bits are promised for each class of processor only, since ODE chooses its code by processor.
#include <map>

#include "tests/dynamics/contract/scenes.h"

namespace visum::dynamics::testing {
namespace {

const std::map<std::string, std::uint64_t> kGolden{
    {"OdeWorld", 0x104bf19a5993ab77ull},       {"OdeQuick", 0xcd99abfa3f8f7fe2ull},
    {"Impulse", 0x3cd952cb145ad54cull},        {"ImpulseOrder4", 0x3177a5dd2d46dd50ull},
    {"ImpulseIterate", 0x4d2c0b2b8c60a9d0ull},
};

class Golden : public Contract {};
VISUM_INSTANTIATE_CONTRACT(Golden);

TEST_P(Golden, AThousandTicksGiveTheKnownHash) {
  Lab lab(busy_model(GetParam().engine));
  set_busy_drives(lab);
  lab.run_ticks(1000);
  ASSERT_TRUE(kGolden.contains(GetParam().name))
      << "this engine has no golden hash yet: 0x" << std::hex << lab.hash();
  EXPECT_EQ(lab.hash(), kGolden.at(GetParam().name)) << std::hex << "now: 0x" << lab.hash();
}

}  // namespace
}  // namespace visum::dynamics::testing
