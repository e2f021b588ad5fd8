// Any bytes as an STL and as an OBJ file. A mesh that is accepted has finite vertices and valid indices; all
// other input is refused.
#include <cstdio>
#include <cstdlib>

#include "server/scene/mesh_readers.h"

namespace {

using namespace visum;

template <typename Reader>
void read(Reader reader, std::string_view bytes) {
  try {
    const world::TriangleMesh mesh = reader(bytes, "mesh");
    for (const auto& vertex : mesh.vertices)
      if (!vertex.allFinite()) std::abort();
    for (const auto& triangle : mesh.triangles)
      for (const auto index : triangle)
        if (index >= mesh.vertices.size()) std::abort();
  } catch (const config::ConfigError&) {
    // refused, as it should be
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  read(scene::read_stl, bytes);
  read(scene::read_obj, bytes);
  return 0;
}
