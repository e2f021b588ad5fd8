// The whole state of a world at a tick border: all that a fresh world of the same scene needs to continue
// with the same bits. Plain values; the vectors keep their capacity.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace visum::recording {

struct State {
  struct Kept {  // a snapshot that can be restored
    std::uint64_t number = 0;
    std::vector<std::byte> state;
  };
  // A body that was added (the YAML of its entry) or removed (its name) since the scene was loaded.
  struct Edit {
    bool came = true;
    std::string text;
    bool operator==(const Edit&) const = default;
  };
  std::int64_t tick = 0;
  std::uint64_t era = 1;
  std::uint64_t revision = 1;  // counts the edits
  std::uint64_t next_snapshot = 1;
  std::vector<std::byte> state;  // the bytes whose XXH64 is the state's hash
  std::vector<Kept> snapshots;
  std::vector<Edit> edits;
};

}  // namespace visum::recording
