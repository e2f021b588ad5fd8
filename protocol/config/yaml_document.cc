#include "protocol/config/yaml_document.h"

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/mark.h>
#include <yaml-cpp/parser.h>

#include <algorithm>
#include <numeric>
#include <sstream>
#include <utility>

namespace visum::config {
namespace {

// Builds the tree from yaml-cpp's events. yaml-cpp calls it while it descends, so throwing at the depth limit
// also bounds yaml-cpp's recursion.
class TreeBuilder : public YAML::EventHandler {
 public:
  explicit TreeBuilder(std::string file) : file_(std::move(file)) {}

  Value take_root() { return std::move(root_); }

  void OnDocumentStart(const YAML::Mark&) override {}
  void OnDocumentEnd() override {}

  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    refuse_anchor(mark, anchor);
    if (expects_key()) fail(mark, "a key is empty");
    add(make(mark, Node::Kind::kNull));
  }

  void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override { fail(mark, kNoAnchors); }
  void OnAnchor(const YAML::Mark& mark, const std::string&) override { fail(mark, kNoAnchors); }

  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& text) override {
    refuse_anchor(mark, anchor);
    refuse_tag(mark, tag);
    const bool plain = tag != "!";  // yaml-cpp's mark for a quoted scalar
    if (expects_key()) return open_entry(mark, text, plain);
    Value value = make(mark, Node::Kind::kScalar);
    value.plain = plain;
    value.scalar = text;
    add(std::move(value));
  }

  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    open(mark, tag, anchor, Node::Kind::kList);
  }
  void OnSequenceEnd() override { close(); }

  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    open(mark, tag, anchor, Node::Kind::kMap);
  }
  void OnMapEnd() override {
    refuse_repeated_keys();
    close();
  }

 private:
  static constexpr const char* kNoAnchors = "anchors and aliases are not supported, write the value out";

  struct Frame {
    Value value;
    bool key_open = false;  // map: the last entry has its key; its value comes next
  };

  bool expects_key() const {
    return !frames_.empty() && frames_.back().value.kind == Node::Kind::kMap && !frames_.back().key_open;
  }

  void refuse_anchor(const YAML::Mark& mark, YAML::anchor_t anchor) const {
    if (anchor != YAML::NullAnchor) fail(mark, kNoAnchors);
  }

  void refuse_tag(const YAML::Mark& mark, const std::string& tag) const {
    if (!tag.empty() && tag != "?" && tag != "!") fail(mark, "tags are not supported ('" + tag + "')");
  }

  Value make(const YAML::Mark& mark, Node::Kind kind) {
    if (++nodes_ > kMaxNodes) fail(mark, "more than " + std::to_string(kMaxNodes) + " values in one file");
    Value value;
    value.kind = kind;
    value.line = mark.line + 1;
    return value;
  }

  void open(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor, Node::Kind kind) {
    refuse_anchor(mark, anchor);
    refuse_tag(mark, tag);
    if (expects_key()) fail(mark, "a key must be a plain text");
    if (frames_.size() >= static_cast<std::size_t>(kMaxDepth))
      throw ConfigError({file_, mark.line + 1, ""},
                        "nested deeper than " + std::to_string(kMaxDepth) + " levels");
    frames_.push_back({make(mark, kind)});
  }

  void open_entry(const YAML::Mark& mark, const std::string& key, bool plain) {
    if (plain && key == "<<") fail(mark, "merge keys ('<<') are not supported, write the values out");
    if (key.size() > kMaxKeyBytes)
      fail(mark, "a key has more than " + std::to_string(kMaxKeyBytes) + " bytes");
    Frame& frame = frames_.back();
    if (frame.value.entries.size() == kMaxKeysPerMap)
      fail(mark, "more than " + std::to_string(kMaxKeysPerMap) + " keys in one map");
    frame.value.entries.push_back({key, mark.line + 1, {}});
    frame.key_open = true;
  }

  void close() {
    Value value = std::move(frames_.back().value);
    frames_.pop_back();
    add(std::move(value));
  }

  void add(Value value) {
    if (frames_.empty()) {
      root_ = std::move(value);
    } else if (Frame& frame = frames_.back(); frame.value.kind == Node::Kind::kList) {
      frame.value.items.push_back(std::move(value));
    } else {
      // For a missing value yaml-cpp gives the place where the next thing begins. Readers look at the key, so
      // take its line.
      if (value.kind == Node::Kind::kNull) value.line = frame.value.entries.back().line;
      frame.value.entries.back().value = std::move(value);
      frame.key_open = false;
    }
  }

  void refuse_repeated_keys() const {
    const std::vector<Entry>& entries = frames_.back().value.entries;
    std::vector<const Entry*> sorted(entries.size());
    std::transform(entries.begin(), entries.end(), sorted.begin(), [](const Entry& e) { return &e; });
    std::stable_sort(sorted.begin(), sorted.end(),
                     [](const Entry* a, const Entry* b) { return a->key < b->key; });
    const auto twin = std::adjacent_find(sorted.begin(), sorted.end(),
                                         [](const Entry* a, const Entry* b) { return a->key == b->key; });
    if (twin == sorted.end()) return;
    throw ConfigError(
        {file_, twin[1]->line, path()},
        "key '" + twin[1]->key + "' appears twice, first on line " + std::to_string(twin[0]->line));
  }

  // The path of the value that is being built, for errors.
  std::string path() const {
    std::string path;
    for (const Frame& frame : frames_) {
      if (frame.value.kind == Node::Kind::kList) path = item_path(path, frame.value.items.size());
      if (frame.key_open) path = member_path(path, frame.value.entries.back().key);
    }
    return path;
  }

  [[noreturn]] void fail(const YAML::Mark& mark, const std::string& message) const {
    throw ConfigError({file_, mark.line + 1, path()}, message);
  }

  std::string file_;
  std::vector<Frame> frames_;
  Value root_;
  std::size_t nodes_ = 0;
};

// Refuses text that would harm yaml-cpp. It takes byte 4 for the end of the text and a NUL for UTF-16, which
// would cut a file short in silence. And it gathers all tokens of a line before the first event, so a line's
// length bounds its memory.
void refuse_hostile_text(const std::string& yaml, const std::string& file) {
  int line = 1;
  std::size_t line_bytes = 0;
  for (const unsigned char c : yaml) {
    line_bytes = c == '\n' ? 0 : line_bytes + 1;
    line += c == '\n';
    if (line_bytes > kMaxLineBytes)
      throw ConfigError({file, line, ""}, "a line has more than " + std::to_string(kMaxLineBytes) + " bytes");
    if (c < 0x20 && c != '\n' && c != '\r' && c != '\t')
      throw ConfigError({file, line, ""}, "holds a control character (code " + std::to_string(c) +
                                              "), is this a text file in UTF-8?");
  }
}

}  // namespace

std::string member_path(const std::string& parent, const std::string& key) {
  return parent.empty() ? key : parent + "." + key;
}

std::string item_path(const std::string& parent, std::size_t index) {
  return item_path(parent, std::to_string(index));
}

std::string item_path(const std::string& parent, const std::string& index) {
  return parent + "[" + index + "]";
}

std::size_t most_values(std::string_view yaml) {
  std::size_t values = 1;  // the root
  for (std::size_t i = 0; i < yaml.size(); ++i) {
    const char c = yaml[i];
    const bool ends =
        i + 1 == yaml.size() || std::string_view(" \t\r\n").find(yaml[i + 1]) != std::string_view::npos;
    values += c == ',' || c == ':' || c == '[' || c == '{' || (c == '-' && ends);
  }
  return values;
}

Value parse_yaml(const std::string& yaml, const std::string& file) {
  refuse_hostile_text(yaml, file);
  std::istringstream stream(yaml);
  TreeBuilder builder(file);
  try {
    YAML::Parser parser(stream);
    parser.HandleNextDocument(builder);
    TreeBuilder rest(file);
    if (parser.HandleNextDocument(rest))
      throw ConfigError({file, 0, ""}, "holds more than one YAML document");
  } catch (const YAML::Exception& error) {
    throw ConfigError({file, error.mark.line + 1, ""}, "not valid YAML: " + error.msg);
  }
  return builder.take_root();
}

}  // namespace visum::config
