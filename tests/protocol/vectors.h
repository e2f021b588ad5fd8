// The conformance vectors: vectors/requests/NAME.bin is one frame with its header, and NAME.json the same
// message in Protobuf's JSON form. Every implementation of the protocol should read the one as the other.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace visum::testing {

struct Vector {
  std::string name;     // "requests/write"
  std::string message;  // "ClientMessage" or "ServerMessage"
  std::vector<std::byte> frame;
};

// The vectors as the codec of this build writes them. The id or reply_to of each is its number in the list,
// from 1.
std::vector<Vector> make_vectors();

std::filesystem::path vector_folder();
std::string read_file(const std::filesystem::path& path);  // throws std::runtime_error if there is none

}  // namespace visum::testing
