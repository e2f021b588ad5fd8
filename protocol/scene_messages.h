// Messages about the scenes and scenarios of the server, as plain values; visum.proto says what they mean.
#pragma once

#include <string>
#include <vector>

namespace visum::protocol {

struct ListScenes {};
struct LoadScene {
  std::string scene;
};

struct SceneList {
  std::vector<std::string> scenes, scenarios;
};

}  // namespace visum::protocol
