#include "server/gateway/working_text.h"

namespace visum::gateway {

using cycle::Stage;

std::string working_text(const cycle::Working::Now& now, const std::vector<const hwparts::Part*>& parts,
                         const std::vector<std::string>& work_texts) {
  const auto name = [&] {
    return now.index < parts.size() ? "'" + parts[now.index]->description().name + "'"
                                    : std::string("a part");
  };
  const auto text = [&](std::size_t i) {
    return i < work_texts.size() ? work_texts[i] : std::string("the world");
  };
  switch (now.stage) {
    case Stage::kNothing:
      return {};
    case Stage::kSense:
      return "reads the joints";
    case Stage::kThink:
      return "agent " + name();
    case Stage::kAct:
      return "part " + name();
    case Stage::kCollide:
      return text(0);
    case Stage::kStep:
      return text(1 + now.index);
    case Stage::kPublish:
      return "sensors";
  }
  return {};
}

}  // namespace visum::gateway
