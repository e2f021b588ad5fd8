#include "tests/protocol/vectors.h"

#include <gtest/gtest.h>

#include <set>

#include "protocol/codec.h"
#include "tests/protocol/schema.h"

namespace visum::testing {
namespace {

std::vector<std::byte> payload_of(const Vector& vector) {
  return {vector.frame.begin() + protocol::kHeaderBytes, vector.frame.end()};
}

// A difference here is a change of the wire format: old clients would read something else.
TEST(Vectors, FilesAreWhatTheCodecWrites) {
  for (const Vector& vector : make_vectors())
    EXPECT_EQ(to_bytes(read_file(vector_folder() / (vector.name + ".bin"))), vector.frame) << vector.name;
}

TEST(Vectors, JsonSaysTheSameAsTheBytes) {
  const Schema schema;
  for (const Vector& vector : make_vectors()) {
    const std::string json = read_file(vector_folder() / (vector.name + ".json"));
    EXPECT_EQ(schema.to_payload(vector.message, json), payload_of(vector)) << vector.name;
    EXPECT_EQ(schema.to_json(vector.message, payload_of(vector)), json) << vector.name;
  }
}

TEST(Vectors, NoFileIsLeftOver) {
  std::set<std::string> names;
  for (const Vector& vector : make_vectors()) names.insert(vector.name);
  std::size_t found = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(vector_folder())) {
    if (entry.path().extension() != ".bin") continue;
    ++found;
    const auto name = std::filesystem::relative(entry.path(), vector_folder()).replace_extension();
    EXPECT_TRUE(names.contains(name.string())) << name;
  }
  EXPECT_EQ(found, names.size());
}

}  // namespace
}  // namespace visum::testing
