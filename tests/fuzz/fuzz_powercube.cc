// Any bytes on the modules' buses. The decoders must survive them and encode again what they decoded. The
// modules, ticked in between, must stay finite and answer with frames that a client can read.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <span>

#include "hwparts/powercube/can_codec.h"
#include "hwparts/powercube/module_bus.h"
#include "hwparts/powercube/serial_codec.h"
#include "tests/hwparts/part_bench.h"
#include "tests/hwparts/rig.h"

namespace {

using namespace visum;
using powercube::Progress;
using Bytes = std::span<const std::uint8_t>;

[[noreturn]] void fail(const char* what) {
  std::fprintf(stderr, "%s\n", what);
  std::abort();
}

void check_progress(Progress progress, std::size_t taken, std::size_t size, std::size_t longest) {
  if (taken > size) fail("more was taken than there is");
  if (progress == Progress::kNeedsMore && (taken != 0 || size >= longest)) fail("waits for more for ever");
  if (progress != Progress::kNeedsMore && taken == 0) fail("stands still");
}

void check_answer(const powercube::Telegram& answer) {
  if (answer.message.size == 0 || answer.kind != powercube::Telegram::Kind::kAnswer) fail("an empty answer");
  const auto encoded = powercube::encode_serial(answer);
  const auto back = powercube::decode_serial(encoded.bytes());
  if (back.progress != Progress::kComplete || !(back.telegram == answer) || !back.checksum_ok)
    fail("an answer does not come back");
}

// The arm, in the state that it had when the fuzzer began.
test::PartBench& fresh_arm() {
  static test::PartBench bench("amtec_arm", test::arm_context(0.001, 0.1, 0.017, ", homed: false"));
  static const auto state = bench.save();
  static const auto plants = bench.plants;
  bench.load(state);
  bench.plants = plants;
  return bench;
}

void obey(test::PartBench& bench, const powercube::Telegram& telegram, powercube::BusFraming framing) {
  if (const auto answer = bench.part->modules()->handle(telegram, framing)) check_answer(*answer);
  bench.tick();
}

void check_arm(const test::PartBench& bench) {
  for (const double output : bench.outputs)
    if (!std::isfinite(output)) fail("a sensor output is not finite");
  for (const auto& plant : bench.plants)
    if (!std::isfinite(plant.joint.position) || std::abs(plant.joint.velocity) > 1e3)
      fail("a joint flew away");
}

void over_serial(Bytes bytes) {
  auto& bench = fresh_arm();
  for (std::size_t at = 0; at < bytes.size();) {
    const auto decoded = powercube::decode_serial(bytes.subspan(at));
    check_progress(decoded.progress, decoded.taken, bytes.size() - at, powercube::kMaxSerialBytes);
    if (decoded.progress == Progress::kNeedsMore) break;
    at += decoded.taken;
    if (decoded.progress != Progress::kComplete) continue;
    const auto again = powercube::decode_serial(powercube::encode_serial(decoded.telegram).bytes());
    if (!(again.telegram == decoded.telegram)) fail("a telegram changed on the way");
    obey(bench, decoded.telegram, powercube::BusFraming::kSerial);
  }
  check_arm(bench);
}

void over_slcan(Bytes bytes) {
  auto& bench = fresh_arm();
  for (std::size_t at = 0; at < bytes.size();) {
    const auto decoded = powercube::decode_slcan(bytes.subspan(at));
    check_progress(decoded.progress, decoded.taken, bytes.size() - at, powercube::kMaxSlcanBytes);
    if (decoded.progress == Progress::kNeedsMore) break;
    at += decoded.taken;
    if (decoded.progress != Progress::kComplete || decoded.kind != powercube::SlcanDecoded::Kind::kFrame)
      continue;
    const auto again = powercube::decode_slcan(powercube::encode_slcan(decoded.frame).bytes());
    const bool same = again.frame.id == decoded.frame.id && again.frame.size == decoded.frame.size;
    if (again.progress != Progress::kComplete || !same) fail("a frame changed on the way");
    if (const auto telegram = powercube::from_can(decoded.frame))
      obey(bench, *telegram, powercube::BusFraming::kCan);
  }
  check_arm(bench);
}

// Passes messages without framing, so that the fuzzer need not find checksums: [module, size, data...],
// repeated.
void as_messages(Bytes bytes) {
  auto& bench = fresh_arm();
  while (bytes.size() >= 2) {
    powercube::Telegram telegram;
    telegram.module = bytes[0] % 9;
    const std::size_t size = std::min<std::size_t>(bytes[1] % 9, bytes.size() - 2);
    for (std::size_t i = 0; i < size; ++i) telegram.message.put(bytes[2 + i]);
    bytes = bytes.subspan(2 + size);
    if (size == 0) continue;
    using Kind = powercube::Telegram::Kind;
    const bool reads = telegram.message.command() == powercube::command::kGetParameter;
    telegram.kind = telegram.module == 0 ? Kind::kBroadcast : reads ? Kind::kGet : Kind::kSet;
    obey(bench, telegram, powercube::BusFraming::kCan);
  }
  bench.run(0.02);
  check_arm(bench);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const Bytes bytes(data, size);
  over_serial(bytes);
  over_slcan(bytes);
  as_messages(bytes);
  return 0;
}
