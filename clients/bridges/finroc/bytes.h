// Reads and writes the plain values of Finroc's streams: little-endian numbers and strings that end with 0.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>

namespace visum::finroc {

// A reader never throws and never reads past the end: it then fails for good and yields zeros.
class Reader {
 public:
  explicit Reader(std::span<const std::byte> bytes) : bytes_(bytes) {}

  template <typename T>
  requires std::is_arithmetic_v<T> T take() {
    T value{};
    const auto bytes = take_bytes(sizeof(T));
    if (!failed_) std::memcpy(&value, bytes.data(), sizeof(T));
    return value;
  }
  bool take_bool() { return take<std::uint8_t>() != 0; }
  std::string take_string();
  std::span<const std::byte> take_bytes(std::size_t count);

  bool failed() const { return failed_; }
  void fail() { failed_ = true; }
  bool at_end() const { return failed_ || position_ == bytes_.size(); }
  std::size_t position() const { return position_; }
  std::size_t left() const { return failed_ ? 0 : bytes_.size() - position_; }

 private:
  std::span<const std::byte> bytes_;
  std::size_t position_ = 0;
  bool failed_ = false;
};

class Writer {
 public:
  template <typename T>
  requires std::is_arithmetic_v<T> Writer& put(T value) {
    char bytes[sizeof(T)];
    std::memcpy(bytes, &value, sizeof(T));
    text_.append(bytes, sizeof(T));
    return *this;
  }
  Writer& put_bool(bool value) { return put<std::uint8_t>(value ? 1 : 0); }
  Writer& put_string(std::string_view text);
  Writer& put_bytes(std::string_view bytes) {
    text_ += bytes;
    return *this;
  }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

}  // namespace visum::finroc
