// Embree's functions, from its shared library. It is loaded for the first world with a camera, or a sensor
// that measures by rays: it is large, and most scenes have neither. Only ray_world.cc and embree.cc include
// this.
#pragma once

#include <embree3/rtcore.h>

#define VISUM_EMBREE_FUNCTIONS(F)       \
  F(AttachGeometry)                     \
  F(AttachGeometryByID)                 \
  F(CommitGeometry)                     \
  F(CommitScene)                        \
  F(Intersect1)                         \
  F(NewDevice)                          \
  F(NewGeometry)                        \
  F(NewScene)                           \
  F(Occluded1)                          \
  F(ReleaseDevice)                      \
  F(ReleaseGeometry)                    \
  F(ReleaseScene)                       \
  F(SetGeometryBoundsFunction)          \
  F(SetGeometryInstancedScene)          \
  F(SetGeometryIntersectFilterFunction) \
  F(SetGeometryIntersectFunction)       \
  F(SetGeometryOccludedFilterFunction)  \
  F(SetGeometryOccludedFunction)        \
  F(SetGeometryTransform)               \
  F(SetGeometryUserData)                \
  F(SetGeometryUserPrimitiveCount)      \
  F(SetNewGeometryBuffer)               \
  F(SetSceneBuildQuality)               \
  F(SetSceneFlags)

namespace visum::sensing {

// rtc.NewScene(...) is rtcNewScene(...).
struct Embree {
#define VISUM_EMBREE_MEMBER(name) decltype(&::rtc##name) name;
  VISUM_EMBREE_FUNCTIONS(VISUM_EMBREE_MEMBER)
#undef VISUM_EMBREE_MEMBER
};

// Loads the library at the first call; it stays until the process ends. Any thread. Throws std::runtime_error
// with the loader's reason where the library or one of the functions is missing.
const Embree& embree();

}  // namespace visum::sensing
