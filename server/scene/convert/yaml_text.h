// Pieces of YAML in its flow form, one entry a line.
#pragma once

#include <map>
#include <string>

#include "protocol/config/config.h"
#include "server/scene/convert/output.h"
#include "server/world/world_model.h"

namespace visum::scene {

std::string yaml_text(const std::string& text);  // in double quotes
std::string yaml_list(const double* numbers, std::size_t count);
std::string yaml_list(const Eigen::Vector3d& vector);
std::string yaml_pose(const world::Pose& pose);

// "{a: 1, b: [2, 3]}", key by key.
class YamlMap {
 public:
  YamlMap& add(const std::string& key, const std::string& value);  // already YAML
  YamlMap& add_text(const std::string& key, const std::string& text) { return add(key, yaml_text(text)); }
  YamlMap& add_number(const std::string& key, double number) { return add(key, exact(number)); }
  // Not at all where it is what is meant without it.
  YamlMap& add_unless(const std::string& key, double number, double usual);
  YamlMap& add_pose(const world::Pose& pose);
  bool empty() const { return text_.empty(); }
  std::string text() const { return "{" + text_ + "}"; }

 private:
  std::string text_;
};

// An entry as it was read, with these keys replaced, or left out where they are replaced by nothing.
std::string yaml_of(const config::Node& node, const std::map<std::string, std::string>& replaced = {});

}  // namespace visum::scene
