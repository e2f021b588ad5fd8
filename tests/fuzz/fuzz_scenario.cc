// Any text as a scenario. Its first runs are read, or it is refused with a ConfigError that names a place.
#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include "clients/visum/run/scenario_reader.h"
#include "clients/visum/run/sweep.h"
#include "protocol/config/flow.h"

namespace {

using visum::config::Node;

bool is_number(const Node& node) try {
  node.number();
  return true;
} catch (const visum::config::ConfigError&) {
  return false;
}

// A number that became a text is another value, too.
bool are_same(const Node& a, const Node& b) {
  if (a.kind() != b.kind()) return false;
  if (a.kind() == Node::Kind::kScalar) return a.text() == b.text() && is_number(a) == is_number(b);
  if (a.kind() == Node::Kind::kMap) {
    const auto keys = a.keys();
    return keys == b.keys() &&
           std::ranges::all_of(keys, [&](const auto& key) { return are_same(a.get(key), b.get(key)); });
  }
  if (a.kind() == Node::Kind::kNull) return true;
  bool same = a.size() == b.size();
  for (std::size_t i = 0; same && i < a.size(); ++i) same = are_same(a.at(i), b.at(i));
  return same;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace visum;
  constexpr std::size_t kMostRuns = 3;
  try {
    const auto root = config::load_text({reinterpret_cast<const char*>(data), size}, "scenario.yaml");
    if (!are_same(root, config::load_text(config::flow(root), "flow"))) {
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
