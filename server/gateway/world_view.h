// The world as messages of the protocol: the answers to DescribeWorld, ReadMesh and ReadTexture.
#pragma once

#include <cstdint>
#include <vector>

#include "protocol/messages.h"
#include "server/scene/scene.h"

namespace visum::gateway {

// It changes only when bodies or models come or go, not by ticks.
struct WorldView {
  protocol::WorldDescription description;
  std::vector<protocol::MeshData> meshes;
  std::vector<protocol::TextureData> textures;
  std::vector<protocol::ModelSpawned> spawned;  // models that came and are there
};
WorldView describe_world(const scene::Scene& scene, std::uint64_t revision);

}  // namespace visum::gateway
