// Any text as a scenario. Its first runs are read, or it is refused with a ConfigError that names a place.
#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include "clients/visum/run/scenario_reader.h"
#include "clients/visum/run/sweep.h"
#include "protocol/config/flow.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace visum;
  constexpr std::size_t kMostRuns = 3;
  try {
    const auto root = config::load_text({reinterpret_cast<const char*>(data), size}, "scenario.yaml");
    if (config::flow(config::load_text(config::flow(root), "flow")) != config::flow(root)) {
      std::fprintf(stderr, "a value changed on its way through one line\n");
      std::abort();
    }
    run::read_scenario(root);
    for (std::size_t i = 2, last = std::min(run::Sweep(root).runs(), kMostRuns); i <= last; ++i)
      run::read_scenario(root, i);
  } catch (const config::ConfigError& error) {
    const bool ours = error.place().file == "flow";
    if (error.place().file.empty() || ours) std::fprintf(stderr, "%s\n", error.what());
    if (error.place().file.empty() || ours) std::abort();
  }
  return 0;
}
