// Flat, byte-exact saving of the changing state of parts, and of everything else that a snapshot holds. It
// saves field by field, so that padding never enters a hash. Native endianness: a snapshot stays on its
// machine.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>
#include <type_traits>
#include <vector>

namespace visum::hwparts {

// Appends to a vector that keeps its capacity, so nothing allocates once warm. The vector has its right size
// only after the writer's destructor. Until then it is as large as its capacity, so that saving a number
// costs one store (a world saves a thousand in a tick).
class StateWriter {
 public:
  explicit StateWriter(std::vector<std::byte>& bytes) : bytes_(bytes), used_(bytes.size()) {
    bytes_.resize(bytes_.capacity());
  }
  ~StateWriter() { bytes_.resize(used_); }
  StateWriter(const StateWriter&) = delete;
  StateWriter& operator=(const StateWriter&) = delete;

  template <typename T>
  requires std::is_arithmetic_v<T> || std::is_enum_v<T>
  void put(T value) { append(&value, sizeof value); }
  void put(std::span<const double> values) { put(std::as_bytes(values)); }
  void put(std::span<const std::byte> bytes) {
    if (!bytes.empty()) append(bytes.data(), bytes.size());
  }

  // Saves many fields in a row: `save` gets a Run to put them to. They take at most `most` bytes. That is one
  // store for each field; through the writer itself each store waits for the one before. So it does where
  // `save` calls a function that is not inlined: the Run lies in memory then, which a store might change.
  class Run {
   public:
    explicit Run(std::byte* next) : next_(next) {}
    template <typename T>
    requires std::is_arithmetic_v<T> || std::is_enum_v<T>
    [[gnu::always_inline]] void put(T value) {
      std::memcpy(next_, &value, sizeof value);
      next_ += sizeof value;
    }

   private:
    friend StateWriter;
    std::byte* next_;
  };
  template <typename Save>
  void put_run(std::size_t most, Save save) {
    make_room(most);
    Run run(bytes_.data() + used_);
    save(run);
    used_ = static_cast<std::size_t>(run.next_ - bytes_.data());
  }

 private:
  void make_room(std::size_t size) {
    if (bytes_.size() - used_ < size) [[unlikely]]
      bytes_.resize(2 * bytes_.size() + size);
  }
  // Always inlined: where a field's size is known this is one store, and a call would cost more.
  [[gnu::always_inline]] void append(const void* from, std::size_t size) {
    make_room(size);
    std::memcpy(bytes_.data() + used_, from, size);
    used_ += size;
  }
  std::vector<std::byte>& bytes_;
  std::size_t used_;
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
  void get(std::span<double> values) { get(std::as_writable_bytes(values)); }
  void get(std::span<std::byte> bytes) { copy(bytes.data(), bytes.size()); }
  bool at_end() const { return bytes_.empty(); }
  // Throws unless at least `size` bytes are left. Called before memory is allocated for them.
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
