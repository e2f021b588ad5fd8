#include "protocol/config/flow.h"

#include <algorithm>
#include <string_view>

#include "protocol/config/yaml_document.h"

namespace visum::config {
namespace {

bool is_plain(char c) {
  return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}

// True for words and numbers that have no special meaning in YAML, in any place: also for -5, .5 and -.inf.
bool is_harmless(std::string_view text) {
  if (text == "null" || text == "Null" || text == "NULL") return false;
  if (text.starts_with('-') || text.starts_with('+')) text.remove_prefix(1);
  if (text.starts_with('.')) text.remove_prefix(1);
  if (text.empty() || !is_plain(text.front())) return false;
  return std::ranges::all_of(
      text, [](char c) { return is_plain(c) || c == '.' || c == '+' || c == '-' || c == '/'; });
}

std::string in_quotes(std::string_view text) {
  constexpr char kHex[] = "0123456789abcdef";
  std::string quoted = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      quoted += '\\';
      quoted += c;
    } else if (byte < 0x20) {
      quoted += "\\x";
      quoted += kHex[byte >> 4];
      quoted += kHex[byte & 15];
    } else {
      quoted += c;
    }
  }
  return quoted + "\"";
}

std::string flow(const Value& value) {
  std::string text;
  const auto add = [&](const std::string& piece) { text += (text.empty() ? "" : ", ") + piece; };
  switch (value.kind) {
    case Node::Kind::kNull:
      return "null";
    case Node::Kind::kScalar:
      return value.plain && is_harmless(value.scalar) ? value.scalar : in_quotes(value.scalar);
    case Node::Kind::kList:
      for (const Value& item : value.items) add(flow(item));
      return "[" + text + "]";
    case Node::Kind::kMap:
      for (const Entry& entry : value.entries)
        add((is_harmless(entry.key) ? entry.key : in_quotes(entry.key)) + ": " + flow(entry.value));
      return "{" + text + "}";
  }
  return text;
}

}  // namespace

std::string flow(const Node& node) {
  return flow(value_of(node));
}

}  // namespace visum::config
