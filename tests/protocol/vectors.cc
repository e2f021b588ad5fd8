#include "tests/protocol/vectors.h"

#include <fstream>
#include <iterator>
#include <stdexcept>

#include "protocol/codec.h"
#include "tests/protocol/sample_messages.h"

namespace visum::testing {

std::vector<Vector> make_vectors() {
  std::vector<Vector> vectors;
  std::uint64_t id = 0;
  for (const auto& [name, request] : sample_requests()) {
    auto& vector = vectors.emplace_back(Vector{"requests/" + name, "ClientMessage", {}});
    protocol::encode_request(++id, request, vector.frame);
  }
  id = 0;
  for (const auto& [name, reply] : sample_replies()) {
    auto& vector = vectors.emplace_back(Vector{"replies/" + name, "ServerMessage", {}});
    protocol::encode_reply(++id, reply, vector.frame);
  }
  return vectors;
}

std::filesystem::path vector_folder() {
  return VISUM_SOURCE_DIR "/tests/protocol/vectors";
}

std::string read_file(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw std::runtime_error("cannot read " + path.string());
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace visum::testing
