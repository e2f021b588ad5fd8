// Configuration files (scenes, drives, scenarios) as a tree of values. Every value knows its file and line,
// so that an error can name the place. Values are checked when they are read: one that is wrong, missing or
// unknown throws ConfigError. Not thread-safe; used before the first tick only. YAML (yaml-cpp) stays inside
// yaml_document.cc.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace visum::config {

// A place in a configuration file.
struct Place {
  std::string file;
  int line = 0;     // from 1; 0: the file as a whole
  std::string key;  // path of the value, "bodies[2].mass"
};

// Wrong configuration. what() reads "file:line: key: message".
class ConfigError : public std::runtime_error {
 public:
  ConfigError(Place place, const std::string& message);
  const Place& place() const { return place_; }
  const std::string& message() const { return message_; }

 private:
  Place place_;
  std::string message_;
};

// Bounds of a number.
struct Range {
  double minimum = -std::numeric_limits<double>::max();  // NaN and infinity are always refused
  double maximum = std::numeric_limits<double>::max();
  bool exclusive_minimum = false;
};
inline constexpr Range kPositive{0.0, std::numeric_limits<double>::max(), true};
inline constexpr Range kNonNegative{0.0, std::numeric_limits<double>::max(), false};

// A view of one value of a document. Copies are cheap and keep the document alive.
class Node {
 public:
  enum class Kind { kNull, kScalar, kList, kMap };

  Kind kind() const;
  const Place& place() const;
  // Throws ConfigError at this value's place.
  [[noreturn]] void fail(const std::string& message) const;

  // Scalars. Conversion is strict: for a number, "abc" or "1e999" throws ConfigError.
  double number(Range range = {}) const;
  std::int64_t integer(std::int64_t minimum = std::numeric_limits<std::int64_t>::min(),
                       std::int64_t maximum = std::numeric_limits<std::int64_t>::max()) const;
  bool boolean() const;
  std::string text() const;
  // Returns one of `choices`. Otherwise the error lists them and names the nearest.
  std::string one_of(const std::vector<std::string>& choices) const;

  // Lists.
  std::size_t size() const;
  Node at(std::size_t index) const;
  std::vector<double> numbers(std::size_t count, Range range = {}) const;  // exactly `count`

  // Maps. get() throws if the key is missing; find() returns nothing then.
  Node get(std::string_view key) const;
  std::optional<Node> find(std::string_view key) const;
  double number_or(std::string_view key, double otherwise, Range range = {}) const;
  std::string text_or(std::string_view key, const std::string& otherwise) const;
  bool boolean_or(std::string_view key, bool otherwise) const;
  std::vector<std::string> keys() const;  // in the order of the file
  // Throws at the first key that is not in `known`, and names the nearest known key.
  void allow_only(const std::vector<std::string_view>& known) const;

  // The folder of this value's file. Relative paths in the file are relative to it.
  std::filesystem::path folder() const;

  struct Data;
  explicit Node(std::shared_ptr<const Data> data);
  const Data& data() const { return *data_; }

 private:
  std::shared_ptr<const Data> data_;
};

inline constexpr std::size_t kMaxFileBytes = 16u << 20;
inline constexpr int kMaxDepth = 64;
inline constexpr std::size_t kMaxNodes = 1'000'000;

// Reads a YAML file or text. Anchors, aliases and merge keys are refused, because they can make a small file
// huge; so is a repeated key. `name` stands for the file in errors about a text.
Node load_file(const std::filesystem::path& path);
Node load_text(const std::string& yaml, const std::string& name, const std::filesystem::path& folder = ".");

// At least as many values as this text holds, if it is YAML: counts the marks that stand before a value or
// behind a key. Found without parsing, so that a text can be refused before that costs time and memory.
std::size_t most_values(std::string_view yaml);

}  // namespace visum::config
