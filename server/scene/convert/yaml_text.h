// Pieces of YAML in its flow form, with one entry on a line.
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

// Builds "{a: 1, b: [2, 3]}" key by key.
class YamlMap {
 public:
  YamlMap& add(const std::string& key, const std::string& value);  // `value` is already YAML
  YamlMap& add_text(const std::string& key, const std::string& text) { return add(key, yaml_text(text)); }
  YamlMap& add_number(const std::string& key, double number) { return add(key, exact(number)); }
  // Adds nothing if `number` is the default.
  YamlMap& add_unless(const std::string& key, double number, double usual);
  YamlMap& add_pose(const world::Pose& pose);
  bool empty() const { return text_.empty(); }
  std::string text() const { return "{" + text_ + "}"; }

 private:
  std::string text_;
};

// An entry as it was read, with the values of these keys replaced. An empty value removes the key.
std::string yaml_of(const config::Node& node, const std::map<std::string, std::string>& replaced = {});

}  // namespace visum::scene
