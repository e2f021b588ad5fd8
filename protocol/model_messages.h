// Messages about models that come into a world that runs, as plain values; visum.proto says what they mean.
#pragma once

#include <string>
#include <vector>

namespace visum::protocol {

struct ModelFile {
  std::string path, content;
};
struct SpawnModel {
  std::string file, name{};
  std::vector<double> pose{};
  bool make_unique = false;
  std::vector<ModelFile> files{};
};
struct RemoveModel {
  std::string name;
};
struct ListModels {};

struct ModelSpawned {
  std::string name;
  std::vector<std::string> bodies, parts;
};
struct ModelList {
  std::vector<std::string> files, spawned;
};

}  // namespace visum::protocol
