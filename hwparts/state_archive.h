// Flat, byte-exact saving of the changing state of parts (and of anything else that a snapshot holds). Field
// by field, so that padding never enters a hash. Native endianness: a snapshot stays on its machine.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <type_traits>
#include <vector>

namespace visum::hwparts {

// Appends to a vector that keeps its capacity: no allocation once warm.
class StateWriter {
 public:
  explicit StateWriter(std::vector<std::byte>& bytes) : bytes_(bytes) {}

  template <typename T>
  requires std::is_arithmetic_v<T> || std::is_enum_v<T>
  void put(T value) {
    const auto* from = reinterpret_cast<const std::byte*>(&value);
    bytes_.insert(bytes_.end(), from, from + sizeof value);
  }
  void put(std::span<const double> values) {
    const auto bytes = std::as_bytes(values);
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
  }

 private:
  std::vector<std::byte>& bytes_;
};

// Reads in the order of writing. Throws std::out_of_range where the bytes end early.
class StateReader {
 public:
  explicit StateReader(std::span<const std::byte> bytes) : bytes_(bytes) {}

  template <typename T>
  requires std::is_arithmetic_v<T> || std::is_enum_v<T>
  void get(T& value) {
    if constexpr (std::is_same_v<T, bool>) {
      std::uint8_t byte = 0;
      copy(&byte, sizeof byte);
      value = byte != 0;
    } else {
      copy(&value, sizeof value);
    }
  }
  void get(std::span<double> values) { copy(values.data(), values.size_bytes()); }
  bool at_end() const { return bytes_.empty(); }
  // So many bytes are to come: before memory is made for them.
  void expect(std::uint64_t size) const {
    if (size > bytes_.size()) throw std::out_of_range("the snapshot's state is shorter than the part's");
  }

 private:
  void copy(void* to, std::size_t size) {
    if (size > bytes_.size()) throw std::out_of_range("the snapshot's state is shorter than the part's");
    // Not memcpy: `to` may be null where there are no bytes.
    std::copy_n(bytes_.begin(), size, static_cast<std::byte*>(to));
    bytes_ = bytes_.subspan(size);
  }
  std::span<const std::byte> bytes_;
};

}  // namespace visum::hwparts
