#include "protocol/config/config.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>
#include <system_error>
#include <utility>

#include "protocol/config/number_text.h"
#include "protocol/config/read_file.h"
#include "protocol/config/unknown_name.h"
#include "protocol/config/yaml_document.h"

namespace visum::config {
namespace {

std::string describe(const Place& place, const std::string& message) {
  std::string text = place.file;
  if (place.line > 0) text += ":" + std::to_string(place.line);
  if (!text.empty()) text += ": ";
  if (!place.key.empty()) text += place.key + ": ";
  return text + message;
}

// A text from the file, as messages quote it: long ones are cut.
std::string shown(std::string text) {
  constexpr std::size_t kLongest = 60;
  if (text.size() > kLongest) text = text.substr(0, kLongest) + "...";
  return text;
}

// "must be ...": the range in words.
std::string demand(const Range& range) {
  const double largest = std::numeric_limits<double>::max();
  if (range.minimum > -largest && range.maximum < largest && !range.exclusive_minimum)
    return "must be between " + number_text(range.minimum) + " and " + number_text(range.maximum);
  std::string text;
  if (range.minimum > -largest)
    text = (range.exclusive_minimum ? "must be greater than " : "must be at least ") +
           number_text(range.minimum);
  if (range.maximum < largest)
    text += (text.empty() ? "must be at most " : " and at most ") + number_text(range.maximum);
  return text;
}

bool inside(const Range& range, double number) {
  if (number > range.maximum || number < range.minimum) return false;
  return !(range.exclusive_minimum && number == range.minimum);
}

// std::from_chars() takes no plus sign, YAML does.
std::string_view without_plus(std::string_view text) {
  const bool plus = text.size() > 1 && text[0] == '+' && text[1] != '-';
  return plus ? text.substr(1) : text;
}

bool is_any_of(std::string_view text, std::initializer_list<std::string_view> words) {
  return std::find(words.begin(), words.end(), text) != words.end();
}

bool is_infinity_or_nan(std::string_view text) {
  if (!text.empty() && (text[0] == '-' || text[0] == '+')) text.remove_prefix(1);
  return is_any_of(text, {".inf", ".Inf", ".INF", ".nan", ".NaN", ".NAN"});
}

}  // namespace

ConfigError::ConfigError(Place place, const std::string& message)
    : std::runtime_error(describe(place, message)), place_(std::move(place)), message_(message) {}

// A node keeps its document alive by it, and points to its value in there.
struct Node::Data {
  std::shared_ptr<const Document> document;
  const Value* value;
  Place place;

  [[noreturn]] void fail_kind(const std::string& wanted) const;
  void demand_kind(Kind kind, const std::string& wanted) const {
    if (value->kind != kind) fail_kind(wanted);
  }
  Node child(const Value& value, const std::string& path) const {
    return Node(std::make_shared<const Data>(Data{document, &value, {place.file, value.line, path}}));
  }
};

// Reports a value of another kind than wanted.
void Node::Data::fail_kind(const std::string& wanted) const {
  std::string is = "is empty";
  if (value->kind == Kind::kScalar) is = "is '" + shown(value->scalar) + "'";
  if (value->kind == Kind::kList) is = "is a list";
  if (value->kind == Kind::kMap) is = "is a map";
  throw ConfigError(place, "must be " + wanted + ", " + is);
}

Node::Node(std::shared_ptr<const Data> data) : data_(std::move(data)) {}

Node::Kind Node::kind() const {
  return data_->value->kind;
}
const Place& Node::place() const {
  return data_->place;
}
void Node::fail(const std::string& message) const {
  throw ConfigError(place(), message);
}
std::filesystem::path Node::folder() const {
  return data_->document->folder;
}

double Node::number(Range range) const {
  data_->demand_kind(Kind::kScalar, "a number");
  const std::string& text = data_->value->scalar;
  if (!data_->value->plain) fail("must be a number, is the text '" + shown(text) + "' in quotes");
  if (is_infinity_or_nan(text)) fail("must be a finite number, is " + text);
  const std::string_view digits = without_plus(text);
  double number = 0.0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  if (end != digits.data() + digits.size() || error == std::errc::invalid_argument)
    data_->fail_kind("a number");
  if (error == std::errc::result_out_of_range)
    fail("must be a number that a double can hold, is " + shown(text));
  if (!std::isfinite(number)) fail("must be a finite number, is " + text);
  if (!inside(range, number)) fail(demand(range) + ", is " + shown(text));
  return number;
}

std::int64_t Node::integer(std::int64_t minimum, std::int64_t maximum) const {
  data_->demand_kind(Kind::kScalar, "a whole number");
  const std::string& text = data_->value->scalar;
  if (!data_->value->plain) fail("must be a whole number, is the text '" + shown(text) + "' in quotes");
  const std::string_view digits = without_plus(text);
  std::int64_t number = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  const bool too_large = error == std::errc::result_out_of_range;
  if (!too_large && (error != std::errc() || end != digits.data() + digits.size()))
    data_->fail_kind("a whole number");
  if (too_large || number < minimum || number > maximum)
    fail("must be a whole number between " + std::to_string(minimum) + " and " + std::to_string(maximum) +
         ", is " + shown(text));
  return number;
}

bool Node::boolean() const {
  data_->demand_kind(Kind::kScalar, "true or false");
  const std::string& text = data_->value->scalar;
  if (data_->value->plain && is_any_of(text, {"true", "True", "TRUE"})) return true;
  if (data_->value->plain && is_any_of(text, {"false", "False", "FALSE"})) return false;
  data_->fail_kind("true or false");
}

std::string Node::text() const {
  data_->demand_kind(Kind::kScalar, "a text");
  return data_->value->scalar;
}

std::string Node::one_of(const std::vector<std::string>& choices) const {
  const std::string word = text();
  if (std::find(choices.begin(), choices.end(), word) != choices.end()) return word;
  std::string list;
  for (const std::string& choice : choices) list += (list.empty() ? "" : ", ") + choice;
  fail("must be one of " + list + ", is '" + shown(word) + "'" + did_you_mean(word, choices));
}

std::size_t Node::size() const {
  data_->demand_kind(Kind::kList, "a list");
  return data_->value->items.size();
}

Node Node::at(std::size_t index) const {
  data_->demand_kind(Kind::kList, "a list");
  const Value& item = data_->value->items.at(index);
  const std::string path =
      item.index.empty() ? item_path(place().key, index) : item_path(place().key, item.index);
  return data_->child(item, path);
}

std::vector<double> Node::numbers(std::size_t count, Range range) const {
  const std::string wanted = "a list of " + std::to_string(count) + " numbers";
  data_->demand_kind(Kind::kList, wanted);
  if (size() != count) fail("must be " + wanted + ", has " + std::to_string(size()));
  std::vector<double> numbers(count);
  for (std::size_t i = 0; i < count; ++i) numbers[i] = at(i).number(range);
  return numbers;
}

Node Node::get(std::string_view key) const {
  auto node = find(key);
  if (!node) fail("key '" + std::string(key) + "' is missing");
  return *node;
}

std::optional<Node> Node::find(std::string_view key) const {
  data_->demand_kind(Kind::kMap, "a map");
  for (const Entry& entry : data_->value->entries)
    if (entry.key == key) return data_->child(entry.value, member_path(place().key, entry.key));
  return std::nullopt;
}

double Node::number_or(std::string_view key, double otherwise, Range range) const {
  const auto node = find(key);
  return node ? node->number(range) : otherwise;
}

std::string Node::text_or(std::string_view key, const std::string& otherwise) const {
  const auto node = find(key);
  return node ? node->text() : otherwise;
}

bool Node::boolean_or(std::string_view key, bool otherwise) const {
  const auto node = find(key);
  return node ? node->boolean() : otherwise;
}

std::vector<std::string> Node::keys() const {
  data_->demand_kind(Kind::kMap, "a map");
  std::vector<std::string> keys;
  for (const Entry& entry : data_->value->entries) keys.push_back(entry.key);
  return keys;
}

void Node::allow_only(const std::vector<std::string_view>& known) const {
  data_->demand_kind(Kind::kMap, "a map");
  for (const Entry& entry : data_->value->entries) {
    if (std::find(known.begin(), known.end(), entry.key) != known.end()) continue;
    const std::vector<std::string> words(known.begin(), known.end());
    throw ConfigError({place().file, entry.line, place().key},
                      "unknown key '" + shown(entry.key) + "'" + did_you_mean(entry.key, words));
  }
}

const Value& value_of(const Node& node) {
  return *node.data().value;
}

Node make_node(Document document, const Place& place) {
  auto kept = std::make_shared<const Document>(std::move(document));
  const Value* root = &kept->root;
  return Node(std::make_shared<const Node::Data>(Node::Data{std::move(kept), root, place}));
}

Node load_text(const std::string& yaml, const std::string& name, const std::filesystem::path& folder) {
  if (yaml.size() > kMaxFileBytes)
    throw ConfigError({name, 0, ""}, "has " + std::to_string(yaml.size()) + " bytes, at most " +
                                         std::to_string(kMaxFileBytes) + " are read");
  Document document{name, folder, parse_yaml(yaml, name)};
  const int line = std::max(document.root.line, 1);
  return make_node(std::move(document), {name, line, ""});
}

Node load_file(const std::filesystem::path& path) {
  const FileContent content = read_file(path, kMaxFileBytes);
  if (!content.fault.empty()) throw ConfigError({path.string(), 0, ""}, content.fault);
  return load_text(content.bytes, path.string(), path.parent_path());
}

}  // namespace visum::config
