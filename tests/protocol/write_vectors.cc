// Writes the conformance vectors anew: write-protocol-vectors FOLDER. Run it when a message is added. The
// bytes of the other vectors must not change (the tests Vectors.* compare them).
#include <filesystem>
#include <fstream>
#include <iostream>

#include "protocol/codec.h"
#include "tests/protocol/schema.h"
#include "tests/protocol/vectors.h"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: write-protocol-vectors FOLDER\n";
    return 2;
  }
  const visum::testing::Schema schema;
  for (const auto& vector : visum::testing::make_vectors()) {
    const std::filesystem::path path = std::filesystem::path(argv[1]) / vector.name;
    std::filesystem::create_directories(path.parent_path());
    std::ofstream(path.string() + ".bin", std::ios::binary)
        .write(reinterpret_cast<const char*>(vector.frame.data()),
               static_cast<std::streamsize>(vector.frame.size()));
    const auto payload = std::span<const std::byte>(vector.frame).subspan(visum::protocol::kHeaderBytes);
    std::ofstream(path.string() + ".json") << schema.to_json(vector.message, payload);
  }
}
