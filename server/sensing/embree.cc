#include "server/sensing/embree.h"

#include "protocol/config/shared_library.h"

namespace visum::sensing {
namespace {

Embree load() {
  const config::SharedLibrary library(VISUM_EMBREE_LIBRARY, "the ray tracer (Embree)", "libembree3-3");
  Embree functions;
#define VISUM_EMBREE_FIND(name) library.find("rtc" #name, functions.name);
  VISUM_EMBREE_FUNCTIONS(VISUM_EMBREE_FIND)
#undef VISUM_EMBREE_FIND
  return functions;
}

}  // namespace

const Embree& embree() {
  static const Embree functions = load();
  return functions;
}

}  // namespace visum::sensing
