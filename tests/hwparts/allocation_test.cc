#include <gtest/gtest.h>

#include "tests/hwparts/part_bench.h"
#include "tests/hwparts/rig.h"
#include "tests/support/allocation_counter.h"

namespace visum::test {
namespace {

TEST(AmtecArm, TicksSavesAndLoadsWithoutAllocating) {
  PartBench bench("amtec_arm", arm_context());
  auto bytes = bench.save();
  bench.set_angles(2.5);  // the run has ramps, a soft limit, a fault and a halt
  const std::size_t reset = 18, halt = 20;
  ASSERT_EQ(bench.part->description().controller_inputs[halt].name, "Halt");

  test_support::AllocationScope scope;
  for (int k = 0; k < 12'000; ++k) {
    if (k == 9000) bench.inputs[halt] = 1.0;
    if (k == 10'000) bench.inputs[reset] = 1.0;
    if (k == 11'000) bench.part->controller_lost();
    bench.tick();
    bytes.clear();
    {
      hwparts::StateWriter writer(bytes);
      bench.part->save(writer);
    }
    hwparts::StateReader reader(bytes);
    bench.part->load(reader);
  }
  EXPECT_EQ(scope.counts().ours, 0u) << scope.describe_ours();
}

}  // namespace
}  // namespace visum::test
