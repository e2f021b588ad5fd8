#include "server/scene/convert/x3d_text.h"

#include <algorithm>
#include <cmath>

#include "protocol/config/config.h"
#include "protocol/config/unknown_name.h"
#include "server/scene/convert/output.h"
#include "server/scene/text_cursor.h"
#include "server/world/turn.h"

namespace visum::scene {

std::string x3d_rotation(const Eigen::Quaterniond& q) {
  const double sine = q.vec().norm();
  if (sine == 0.0) return "0 0 1 0";
  const double angle = 2.0 * config::arc_tangent(sine, q.w());
  const Eigen::Vector3d axis = q.vec() / sine;
  return exact(axis.data(), 3) + " " + exact(angle);
}

Eigen::Quaterniond quaternion_of_rotation(const double numbers[4]) {
  const Eigen::Vector3d axis(numbers[0], numbers[1], numbers[2]);
  if (numbers[3] == 0.0 || axis.norm() == 0.0) return Eigen::Quaterniond::Identity();
  return world::turn_about(axis.normalized(), numbers[3]);
}

std::string x3d_texts(const std::vector<std::string>& texts) {
  std::string value;
  for (const std::string& text : texts) {
    value += value.empty() ? "\"" : " \"";
    for (const char c : text) {
      if (c == '"' || c == '\\') value += '\\';
      value += c;
    }
    value += '"';
  }
  return value;
}

std::vector<std::string> texts_of(const std::string& value) {
  std::vector<std::string> texts;
  for (std::size_t i = 0; i < value.size(); ++i) {
    if (value[i] != '"') continue;
    texts.emplace_back();
    for (++i; i < value.size() && value[i] != '"'; ++i) {
      if (value[i] == '\\' && i + 1 < value.size()) ++i;
      texts.back() += value[i];
    }
  }
  return texts;
}

Eigen::Quaterniond from_y_to_z() {
  const double half = std::sqrt(0.5);
  return {half, half, 0.0, 0.0};
}

void fail_at(const X3dNode& node, const std::string& file, const std::string& message) {
  throw config::ConfigError({file_of(node, file), node.line, title_of(node)}, message);
}

const std::string& file_of(const X3dNode& node, const std::string& file) {
  return node.file ? *node.file : file;
}

std::string name_in_file(const X3dNode& node) {
  return node.def.substr(0, node.def.find(kX3dMark));
}

std::string title_of(const X3dNode& node) {
  const std::string name = name_in_file(node);
  return (node.prototype.empty() ? node.type : node.prototype) + (name.empty() ? "" : " '" + name + "'");
}

std::vector<double> numbers_of(const X3dNode& node, const std::string& field, std::size_t count,
                               const std::vector<double>& otherwise, const std::string& file) {
  const auto found = node.values.find(field);
  if (found == node.values.end()) return otherwise;
  std::string text = found->second;
  std::ranges::replace(text, ',', ' ');
  std::vector<double> numbers;
  TextCursor cursor(text);
  for (std::string_view word = cursor.word(); !word.empty(); word = cursor.word()) {
    double number = 0.0;
    if (!parse_number(word, number) || !std::isfinite(number))
      fail_at(node, file, field + ": '" + std::string(word.substr(0, 40)) + "' is not a finite number");
    numbers.push_back(number);
  }
  if (count != 0 && numbers.size() != count)
    fail_at(node, file,
            field + " must be " + std::to_string(count) + (count == 1 ? " number" : " numbers") + ", has " +
                std::to_string(numbers.size()));
  return numbers;
}

bool flag_of(const X3dNode& node, const std::string& field, bool otherwise, const std::string& file) {
  const auto found = node.values.find(field);
  if (found == node.values.end()) return otherwise;
  if (found->second != "true" && found->second != "false")
    fail_at(node, file, field + " must be true or false, is '" + found->second.substr(0, 40) + "'");
  return found->second == "true";
}

std::string unknown_use(const std::string& use, const std::map<std::string, const X3dNode*>& defs) {
  std::vector<std::string> known;
  for (const auto& [name, node] : defs) known.push_back(name);
  return "there is no node DEF '" + use + "' before it" + config::did_you_mean(use, known);
}

std::string flat_name(std::string name) {
  std::ranges::replace(name, '/', '.');
  return name;
}

}  // namespace visum::scene
