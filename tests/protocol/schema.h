// visum.proto, read at run time: converts messages between bytes and JSON, and visits their numeric fields.
// Independent of the codec and of the code generated for it, so that the codec can be checked against it.
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
  Schema();  // throws std::runtime_error if the description that protoc wrote cannot be read
  ~Schema();

  // `message` is "ClientMessage" or "ServerMessage"; `payload` has no frame header. Throws std::runtime_error
  // if the bytes or the JSON do not fit the schema.
  std::string to_json(const std::string& message, std::span<const std::byte> payload) const;
  std::vector<std::byte> to_payload(const std::string& message, const std::string& json) const;

  // Calls `visit` for every number in the message, at any depth, and for every extreme value of its type
  // (NaN, infinities, 1e308, the smallest and largest integer): with the payload in which that one number is
  // replaced. `where` reads "write.values[0] = nan".
  using Visit = std::function<void(const std::string& where, std::span<const std::byte> payload)>;
  void for_each_extreme(const std::string& message, std::span<const std::byte> payload,
                        const Visit& visit) const;

  // The fields, at any depth, that the message leaves at their default. Of a oneof only the chosen field
  // counts.
  std::vector<std::string> unset_fields(const std::string& message, std::span<const std::byte> payload) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// Converts between bytes and text, which Protobuf and files use for bytes.
std::vector<std::byte> to_bytes(const std::string& text);

}  // namespace visum::testing
