// Numbers and texts in MCAP's form: little-endian, and each text after its length. The reader does not throw.
// After the end of its bytes it returns zeros, and complete() is false from then on. So a caller reads all
// fields first and checks once. Not thread-safe.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <type_traits>
#include <vector>

namespace visum::recording {

using Bytes = std::span<const std::byte>;

inline Bytes bytes_of(std::string_view text) {
  return std::as_bytes(std::span(text.data(), text.size()));
}

// Writes a number to where there is room for it, and returns the place behind it.
template <typename T>
requires std::is_unsigned_v<T> std::byte* put_number(std::byte* at, T value) {
  for (std::size_t i = 0; i < sizeof(T); ++i)
    *at++ = static_cast<std::byte>(static_cast<std::uint64_t>(value) >> (8 * i));
  return at;
}

// Appends to a vector of the caller, which keeps its capacity.
class LittleWriter {
 public:
  explicit LittleWriter(std::vector<std::byte>& out) : out_(out) {}

  template <typename T>
  requires std::is_unsigned_v<T>
  void number(T value) {
    const auto at = out_.size();
    out_.resize(at + sizeof(T));
    put_number(out_.data() + at, value);
  }
  void raw(Bytes bytes) { out_.insert(out_.end(), bytes.begin(), bytes.end()); }
  void text(std::string_view text) {
    number(static_cast<std::uint32_t>(text.size()));
    raw(bytes_of(text));
  }

 private:
  std::vector<std::byte>& out_;
};

class LittleReader {
 public:
  explicit LittleReader(Bytes bytes) : left_(bytes) {}

  template <typename T>
  requires std::is_unsigned_v<T> T number() {
    const auto bytes = raw(sizeof(T));
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < bytes.size(); ++i)
      value |= std::to_integer<std::uint64_t>(bytes[i]) << (8 * i);
    return static_cast<T>(value);
  }
  // A view of the next `size` bytes; empty if there are fewer.
  Bytes raw(std::uint64_t size) {
    if (size > left_.size()) {
      complete_ = false;
      left_ = {};
      return {};
    }
    const auto bytes = left_.first(static_cast<std::size_t>(size));
    left_ = left_.subspan(bytes.size());
    return bytes;
  }
  std::string_view text() {
    const auto bytes = raw(number<std::uint32_t>());
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }
  Bytes rest() { return raw(left_.size()); }
  bool at_end() const { return left_.empty(); }
  Bytes left() const { return left_; }
  bool complete() const { return complete_; }  // false: more was read than there was

 private:
  Bytes left_;
  bool complete_ = true;
};

}  // namespace visum::recording
