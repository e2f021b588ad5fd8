// A plug-in with an engine whose name a built-in engine has.
#include "protocol/plugin/plugin.h"

namespace {

using namespace visum::plugin;

class Nothing final : public Engine {
 public:
  explicit Nothing(EngineContext&) {}
  void step(const EngineTick&) override {}
};
constexpr EngineKind kEngines[] = {{"ode", "not the usual one", make_engine<Nothing>}};

}  // namespace

VISUM_PLUGIN({.name = "usurper", .engines = kEngines})
