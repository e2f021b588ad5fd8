// A block of rows beside the ports, for what is no vector of numbers: a path, a picture, a text. It belongs
// to the part, under a name that is the part's own, whichever of its modules made it.
//
//   visum::mca::Blackboard way_{*this, "Way", {.content_type = "application/x-float64",
//                                              .row_bytes = 8 * sizeof(double), .most_rows = 64}};
//
// Tools see it in the list of modules. Other programs read it at the part's own port, and write it there
// under the part's lease. Everything happens on the one thread of the part's loop, between its cycles.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace visum::protocol {
struct Blackboard;  // part_description.h
}

namespace visum::mca {

class Module;

struct BlackboardOptions {
  // MIME style. Tools show "text/plain", and rows of numbers as "application/x-float64" or "x-float32".
  std::string content_type = "text/plain";
  std::size_t row_bytes = 1;
  std::size_t most_rows = 1024;
  bool writable = false;  // by other programs; modules may always write
};

class Blackboard {
 public:
  // Throws std::invalid_argument if the part has a blackboard of that name, if a row has no bytes, or if all
  // rows have more than kMostBytes.
  Blackboard(Module& module, std::string name, BlackboardOptions options = {});
  Blackboard(const Blackboard&) = delete;
  Blackboard& operator=(const Blackboard&) = delete;

  static constexpr std::size_t kMostBytes = 16u << 20;

  const std::string& name() const { return name_; }
  const BlackboardOptions& options() const { return options_; }
  std::span<const std::byte> bytes() const { return bytes_; }
  std::size_t rows() const { return bytes_.size() / options_.row_bytes; }
  // Grows with each write.
  std::uint64_t generation() const { return generation_; }

  // At offset 0 the data become the whole content; otherwise they stand at their offset, which must not be
  // behind the end. Returns why they cannot be written; empty: done.
  std::string write(std::span<const std::byte> data, std::uint64_t offset = 0);

  protocol::Blackboard description() const;

 private:
  const std::string name_;
  const BlackboardOptions options_;
  std::vector<std::byte> bytes_;
  std::uint64_t generation_ = 0;
};

}  // namespace visum::mca
