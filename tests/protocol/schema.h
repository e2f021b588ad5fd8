// visum.proto read at run time: messages as JSON and as bytes, and one by one their numeric fields.
// Independent of the codec and of the code generated for it, so that the one can be checked against the
// other.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace visum::testing {

class Schema {
 public:
  Schema();  // throws std::runtime_error where the description that protoc wrote cannot be read
  ~Schema();

  // `message` is "ClientMessage" or "ServerMessage"; `payload` is without the frame's header. Throws
  // std::runtime_error where the bytes or the JSON do not fit the schema.
  std::string to_json(const std::string& message, std::span<const std::byte> payload) const;
  std::vector<std::byte> to_payload(const std::string& message, const std::string& json) const;

  // For every number in the message, at any depth, and every extreme value of its type (NaN, infinities,
  // 1e308, the smallest and largest integer): the payload with that one number replaced. `where` is
  // "write.values[0] = nan".
  using Visit = std::function<void(const std::string& where, std::span<const std::byte> payload)>;
  void for_each_extreme(const std::string& message, std::span<const std::byte> payload,
                        const Visit& visit) const;

  // The fields, at any depth, that the message leaves at their default; of a oneof only the chosen one
  // counts.
  std::vector<std::string> unset_fields(const std::string& message, std::span<const std::byte> payload) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// Bytes as text for Protobuf and files, and back.
std::vector<std::byte> to_bytes(const std::string& text);

}  // namespace visum::testing
