#include "protocol/config/expand.h"

#include <charconv>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "protocol/config/expression.h"
#include "protocol/config/unknown_name.h"
#include "protocol/config/yaml_document.h"

namespace visum::config {
namespace {

constexpr const char* kRepeat = "repeat";
constexpr const char* kIndex = "index";          // the name that `repeat: N` counts with
constexpr std::size_t kMaxTextBytes = 1u << 16;  // of one computed text
constexpr std::size_t kMaxCounters = 3;

struct Counter {
  std::string name;
  std::int64_t count;
};

using Scope = std::map<std::string, const Value*>;

// One step of the path to a value: into an entry of a map, or an item of a list.
struct Step {
  const std::string* key;
  std::size_t item;
};

std::string written(double number) {
  char buffer[32];
  const bool whole = number == std::floor(number) && std::abs(number) < 1e15;
  const auto end = whole ? std::to_chars(buffer, buffer + sizeof buffer, std::llround(number)).ptr
                         : std::to_chars(buffer, buffer + sizeof buffer, number).ptr;
  return std::string(buffer, end);
}

Value number_value(double number, int line) {
  Value value;
  value.kind = Node::Kind::kScalar;
  value.plain = true;
  value.line = line;
  value.scalar = written(number);
  return value;
}

// Walks the tree and builds the expanded one. way_ is the path to the value in hand, for errors; the budget
// counts every value that is made.
class Expander {
 public:
  Expander(const Node& root, ExpansionBudget& budget) : root_(root), budget_(budget) {}

  Value expand(const Value& from, const Scope& scope) {
    spend(from.line);
    if (from.kind == Node::Kind::kScalar) return scalar(from, scope);
    Value to = bare(from);
    for (std::size_t i = 0; i < from.items.size(); ++i) {
      way_.push_back({nullptr, i});
      expand_item(from.items[i], i, scope, to.items);
      way_.pop_back();
    }
    for (const Entry& entry : from.entries) {
      if (entry.key.find("${") != std::string::npos) fail(entry.line, "a key cannot be computed");
      way_.push_back({&entry.key, 0});
      to.entries.push_back({entry.key, entry.line, expand(entry.value, scope)});
      way_.pop_back();
    }
    return to;
  }

 private:
  [[noreturn]] void fail(int line, const std::string& message) const {
    throw ConfigError({root_.place().file, line, path()}, message);
  }

  std::string path() const {
    std::string path = root_.place().key;
    for (const Step& step : way_) path = step.key ? member_path(path, *step.key) : item_path(path, step.item);
    return path;
  }

  // Takes one value from the budget, and fails if there is none left.
  void spend(int line) {
    if (budget_.values == 0)
      fail(line,
           "more than " + std::to_string(kMaxExpanded) + " values, with all that is repeated and included");
    --budget_.values;
  }

  // A map or list of the same kind and line, without its content.
  static Value bare(const Value& from) {
    Value to;
    to.kind = from.kind;
    to.line = from.line;
    return to;
  }

  // ---- repetition ----

  // Appends an item of a list, or as many as its `repeat` says.
  void expand_item(const Value& item, std::size_t place, const Scope& scope, std::vector<Value>& to) {
    const Entry* repeat = find_repeat(item);
    if (!repeat) {
      to.push_back(expand(item, scope));
      to.back().index = std::to_string(place);
      return;
    }
    Value once = item;
    std::erase_if(once.entries, [](const Entry& entry) { return entry.key == kRepeat; });
    way_.push_back({&repeat->key, 0});
    const auto counters = read_counters(expand(repeat->value, scope), repeat->line);
    way_.pop_back();
    std::vector<Value> numbers(counters.size());
    count(once, std::to_string(place), counters, numbers, 0, scope, to);
  }

  static const Entry* find_repeat(const Value& item) {
    for (const Entry& entry : item.entries)
      if (entry.key == kRepeat) return &entry;
    return nullptr;
  }

  // The counters of `repeat`: one called "index" for a number, else one for each name of the map.
  std::vector<Counter> read_counters(const Value& repeat, int line) const {
    std::vector<Counter> counters;
    if (repeat.kind == Node::Kind::kScalar) counters.push_back({kIndex, read_count(repeat)});
    for (const Entry& entry : repeat.entries) {
      if (const auto fault = variable_name_fault(entry.key); !fault.empty())
        fail(entry.line, "'" + entry.key + "' " + fault);
      counters.push_back({entry.key, read_count(entry.value)});
    }
    if (counters.empty() || counters.size() > kMaxCounters)
      fail(line, "must be a number, or a map of 1 to 3 names to numbers");
    double all = 1.0;
    for (const Counter& counter : counters) all *= static_cast<double>(counter.count);
    if (all > static_cast<double>(kMaxRepeats))
      fail(line, "must be at most " + std::to_string(kMaxRepeats) + " in all, is " + written(all));
    return counters;
  }

  std::int64_t read_count(const Value& value) const { return node_of(value).integer(0, kMaxRepeats); }

  // Makes a repeat's value a document of its own, to use Node's strict reading and its errors.
  Node node_of(const Value& value) const {
    return make_node({root_.place().file, root_.folder(), value}, {root_.place().file, value.line, path()});
  }

  // Counts through counters[level] and those behind it, and appends the item at each combination. `label`
  // names the item in errors: "2, row 1, column 0".
  void count(const Value& item, const std::string& label, const std::vector<Counter>& counters,
             std::vector<Value>& numbers, std::size_t level, const Scope& scope, std::vector<Value>& to) {
    if (level == counters.size()) {
      to.push_back(expand(item, scope));
      to.back().index = label;
      return;
    }
    for (std::int64_t i = 0; i < counters[level].count; ++i) {
      numbers[level] = number_value(static_cast<double>(i), item.line);
      Scope inner = scope;
      inner[counters[level].name] = &numbers[level];
      count(item, label + ", " + counters[level].name + " " + std::to_string(i), counters, numbers, level + 1,
            inner, to);
    }
  }

  // ---- ${...} ----

  Value scalar(const Value& from, const Scope& scope) {
    const std::string& text = from.scalar;
    std::size_t at = text.find("${");
    if (at == std::string::npos) return from;
    if (at == 0 && closing(text, 0, from.line) == text.size() - 1)
      return whole(text.substr(2, text.size() - 3), from.line, scope);
    Value to = from;
    to.scalar.clear();
    std::size_t copied = 0;
    for (; at != std::string::npos; at = text.find("${", copied)) {
      const bool escaped = at > copied && text[at - 1] == '$';
      to.scalar += text.substr(copied, at - copied - (escaped ? 1 : 0));
      const std::size_t end = escaped ? at + 1 : closing(text, at, from.line);
      to.scalar += escaped ? "${" : as_text(text.substr(at + 2, end - at - 2), from.line, scope);
      copied = end + 1;
      if (to.scalar.size() > kMaxTextBytes) fail(from.line, "a computed text is too long");
    }
    to.scalar += text.substr(copied);
    return to;
  }

  std::size_t closing(const std::string& text, std::size_t at, int line) const {
    const std::size_t end = text.find('}', at);
    if (end == std::string::npos) fail(line, "'" + text.substr(at, 40) + "' has no '}'");
    return end;
  }

  // A value that is one variable and nothing else keeps the variable's kind: a list stays a list.
  Value whole(const std::string& inside, int line, const Scope& scope) {
    const std::string name = trimmed(inside);
    if (!is_variable_name(name) || is_reserved_name(name))
      return number_value(sum(inside, line, scope), line);
    return placed(variable(name, line, scope), line);
  }

  // Copies a variable's value. In errors it has the place where it is used.
  Value placed(const Value& from, int line) {
    spend(line);
    Value to = from;
    to.line = line;
    to.items.clear();
    to.entries.clear();
    to.items.reserve(from.items.size());
    to.entries.reserve(from.entries.size());
    for (const Value& item : from.items) to.items.push_back(placed(item, line));
    for (const Entry& entry : from.entries)
      to.entries.push_back({entry.key, line, placed(entry.value, line)});
    return to;
  }

  std::string as_text(const std::string& inside, int line, const Scope& scope) {
    const std::string name = trimmed(inside);
    if (!is_variable_name(name) || is_reserved_name(name)) return written(sum(inside, line, scope));
    const Value& value = variable(name, line, scope);
    if (value.kind != Node::Kind::kScalar)
      fail(line, "'" + name + "' is a list or a map, and no text may stand beside it");
    return value.scalar;
  }

  double sum(const std::string& text, int line, const Scope& scope) {
    try {
      return evaluate(text, [&](const std::string& name) { return as_number(name, line, scope); });
    } catch (const std::invalid_argument& error) {
      fail(line, "'${" + text.substr(0, 60) + "}': " + error.what());
    }
  }

  double as_number(const std::string& name, int line, const Scope& scope) const {
    const Value& value = variable(name, line, scope);
    double number = 0.0;
    const char* end = value.scalar.data() + value.scalar.size();
    const auto [stop, error] = std::from_chars(value.scalar.data(), end, number);
    if (value.kind != Node::Kind::kScalar || stop != end || error != std::errc())
      fail(line, "'" + name + "' is no number");
    return number;
  }

  const Value& variable(const std::string& name, int line, const Scope& scope) const {
    const auto found = scope.find(name);
    if (found != scope.end()) return *found->second;
    std::vector<std::string> known;
    for (const auto& [key, value] : scope) known.push_back(key);
    fail(line, unknown_name("parameter", name, known));
  }

  static std::string trimmed(const std::string& text) {
    const std::size_t first = text.find_first_not_of(' ');
    if (first == std::string::npos) return {};
    return text.substr(first, text.find_last_not_of(' ') - first + 1);
  }

  const Node& root_;
  ExpansionBudget& budget_;
  std::vector<Step> way_;
};

}  // namespace

Node expanded(const Node& node, const Variables& variables, ExpansionBudget& budget) {
  Scope scope;
  for (const auto& [name, value] : variables) scope[name] = &value_of(value);
  Value value = Expander(node, budget).expand(value_of(node), scope);
  return make_node({node.place().file, node.folder(), std::move(value)}, node.place());
}

std::string variable_name_fault(const std::string& text) {
  if (!is_variable_name(text)) return "is no name: letters, digits and '_', no digit first";
  return is_reserved_name(text) ? "is the name of a function or number" : "";
}

}  // namespace visum::config
