// Something about a model's file that its user should know: a loss, or a repair.
#pragma once

#include <string>
#include <string_view>

namespace visum::scene {

struct Remark {
  std::string text;       // one sentence
  int line = 0;           // in the model's file; 0: unknown
  std::string file = {};  // the file, if the model's file includes it; empty: the model's own

  bool operator==(std::string_view other) const { return text == other; }
};

}  // namespace visum::scene
