// A YAML document as a plain tree, read through yaml-cpp's events, with limits on depth, nodes and keys.
// Inner header of protocol/config: config.cc reads the tree, expand.cc makes new ones, and yaml_document.cc
// builds it from text. Only yaml_document.cc knows yaml-cpp.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "protocol/config/config.h"

namespace visum::config {

struct Entry;

struct Value {
  Node::Kind kind = Node::Kind::kNull;
  bool plain = false;  // scalar without quotes: may be a number or a boolean
  int line = 0;        // from 1
  std::string scalar;
  // For an item whose place in the list is not its number: shown in errors in its stead, "2, row 1".
  std::string index;
  std::vector<Value> items;    // of a list
  std::vector<Entry> entries;  // of a map, in the order of the file
};

struct Entry {
  std::string key;
  int line = 0;  // of the key
  Value value;
};

struct Document {
  std::string file;  // as shown in errors
  std::filesystem::path folder;
  Value root;
};

inline constexpr std::size_t kMaxKeysPerMap = 10'000;  // look-ups are linear
// YAML finds the colon behind a key only within 1024 bytes. A quoted key may take four bytes for each of its
// own.
inline constexpr std::size_t kMaxKeyBytes = 250;
inline constexpr std::size_t kMaxLineBytes = 1u << 20;

// Paths of values: "bodies" + "mass" -> "bodies.mass", "bodies" + 2 -> "bodies[2]".
std::string member_path(const std::string& parent, const std::string& key);
std::string item_path(const std::string& parent, std::size_t index);
std::string item_path(const std::string& parent, const std::string& index);

// Converts between a node and its value.
const Value& value_of(const Node& node);
Node make_node(Document document, const Place& place);

// Throws ConfigError for text that is not YAML or exceeds a limit, and for what is refused: anchors, aliases,
// merge keys, tags, several documents, repeated keys, keys that are not scalars, control characters.
Value parse_yaml(const std::string& yaml, const std::string& file);

}  // namespace visum::config
