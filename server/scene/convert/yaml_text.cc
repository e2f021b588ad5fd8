#include "server/scene/convert/yaml_text.h"

#include <set>

namespace visum::scene {
namespace {

using config::Node;

// True for a scalar that YAML reads as a number, so that it needs no quotes.
bool is_number(const Node& node) {
  try {
    node.number();
    return true;
  } catch (const config::ConfigError&) {
    return false;
  }
}

bool is_boolean(const Node& node) {
  try {
    node.boolean();
    return true;
  } catch (const config::ConfigError&) {
    return false;
  }
}

std::string list_of(const Node& node) {
  std::string text;
  for (std::size_t i = 0; i < node.size(); ++i) text += (i == 0 ? "" : ", ") + yaml_of(node.at(i));
  return "[" + text + "]";
}

std::string map_of(const Node& node, const std::map<std::string, std::string>& replaced) {
  YamlMap map;
  std::set<std::string> done;
  for (const std::string& key : node.keys()) {
    const auto other = replaced.find(key);
    if (other == replaced.end())
      map.add(key, yaml_of(node.get(key)));
    else if (!other->second.empty())
      map.add(key, other->second);
    done.insert(key);
  }
  for (const auto& [key, value] : replaced)
    if (!value.empty() && !done.contains(key)) map.add(key, value);
  return map.text();
}

bool is_plain_key(const std::string& key) {
  if (key.empty()) return false;
  for (const char c : key)
    if (!((c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_')) return false;
  return true;
}

}  // namespace

std::string yaml_text(const std::string& text) {
  constexpr const char* kDigits = "0123456789abcdef";
  std::string quoted = "\"";
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      quoted += '\\';
      quoted += c;
    } else if (byte < 0x20 || byte == 0x7f) {
      quoted += "\\x";
      quoted += kDigits[byte >> 4];
      quoted += kDigits[byte & 15];
    } else {
      if (c == '$' && i + 1 < text.size() && text[i + 1] == '{') quoted += '$';  // so that it is not expanded
      quoted += c;
    }
  }
  return quoted + "\"";
}

std::string yaml_list(const double* numbers, std::size_t count) {
  return "[" + exact(numbers, count, ", ") + "]";
}

std::string yaml_list(const Eigen::Vector3d& vector) {
  return yaml_list(vector.data(), 3);
}

std::string yaml_pose(const world::Pose& pose) {
  const double wxyz[] = {pose.q.w(), pose.q.x(), pose.q.y(), pose.q.z()};
  YamlMap map;
  if (pose.p != Eigen::Vector3d::Zero()) map.add("xyz", yaml_list(pose.p));
  if (pose.q.coeffs() != Eigen::Quaterniond::Identity().coeffs()) map.add("wxyz", yaml_list(wxyz, 4));
  return map.text();
}

YamlMap& YamlMap::add(const std::string& key, const std::string& value) {
  text_ += (text_.empty() ? "" : ", ") + (is_plain_key(key) ? key : yaml_text(key)) + ": " + value;
  return *this;
}

YamlMap& YamlMap::add_unless(const std::string& key, double number, double usual) {
  return number == usual ? *this : add_number(key, number);
}

YamlMap& YamlMap::add_pose(const world::Pose& pose) {
  const std::string text = yaml_pose(pose);
  return text == "{}" ? *this : add("pose", text);
}

std::string yaml_of(const Node& node, const std::map<std::string, std::string>& replaced) {
  switch (node.kind()) {
    case Node::Kind::kNull:
      return "null";
    case Node::Kind::kList:
      return list_of(node);
    case Node::Kind::kMap:
      return map_of(node, replaced);
    case Node::Kind::kScalar:
      break;
  }
  return is_number(node) || is_boolean(node) ? node.text() : yaml_text(node.text());
}

}  // namespace visum::scene
