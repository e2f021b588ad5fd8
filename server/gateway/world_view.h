// The world in the protocol's words: what DescribeWorld, ReadMesh and ReadWorld answer.
#pragma once

#include <cstdint>
#include <vector>

#include "protocol/messages.h"
#include "server/scene/scene.h"

namespace visum::gateway {

// What does not change while ticking.
struct WorldView {
  protocol::WorldDescription description;
  std::vector<protocol::MeshData> meshes;
  std::vector<protocol::TextureData> textures;
};
WorldView describe_world(const scene::Scene& scene, std::uint64_t revision);

}  // namespace visum::gateway
