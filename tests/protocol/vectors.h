// The conformance vectors: vectors/requests/NAME.bin is one frame, header included; NAME.json is its message
// in Protobuf's JSON form. Every implementation of the protocol should read the one and know it for the
// other.
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

// As the codec of this build writes them; the id or reply_to of each is its place in the list, from 1.
std::vector<Vector> make_vectors();

std::filesystem::path vector_folder();
std::string read_file(const std::filesystem::path& path);  // throws std::runtime_error where there is none

}  // namespace visum::testing
