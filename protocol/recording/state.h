// The whole state of a world at a tick border: all that a fresh world of the same scene needs to continue
// with the same bits. Plain values; the vectors keep their capacity.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "protocol/recording/spawned_model.h"

namespace visum::recording {

struct State {
  struct Kept {  // a snapshot that can be restored
    std::uint64_t number = 0;
    std::vector<std::byte> state;
  };
  // A body or model that came or went since the scene was loaded.
  struct Edit {
    enum class Kind { kBodyCame, kBodyWent, kModelCame, kModelWent };
    Kind kind = Kind::kBodyCame;
    std::string text;                           // the YAML of a body that came, or the name of what went
    std::shared_ptr<const SpawnedModel> model;  // kModelCame
    bool operator==(const Edit& other) const {
      const bool same_model = model == other.model || (model && other.model && *model == *other.model);
      return kind == other.kind && text == other.text && same_model;
    }
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
