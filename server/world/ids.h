// Typed indices, so that a BodyId cannot be passed as a JointId. An id is stable until a body is removed; -1
// means none.
#pragma once

#include <compare>
#include <cstdint>

namespace visum::world {

template <typename Tag>
struct Id {
  std::int32_t value = -1;

  constexpr bool valid() const { return value >= 0; }
  constexpr std::size_t index() const { return static_cast<std::size_t>(value); }
  constexpr auto operator<=>(const Id&) const = default;
};

using BodyId = Id<struct BodyTag>;
using JointId = Id<struct JointTag>;
using ShapeId = Id<struct ShapeTag>;
using SurfaceId = Id<struct SurfaceTag>;
using MeshId = Id<struct MeshTag>;

}  // namespace visum::world
