#include "server/scene/includes.h"

#include <algorithm>
#include <system_error>

#include "protocol/config/read_file.h"
#include "server/scene/frames.h"
#include "server/scene/values.h"

namespace visum::scene {
namespace {

namespace fs = std::filesystem;
using config::Node;

const char* word_for(Node::Kind kind) {
  switch (kind) {
    case Node::Kind::kList:
      return "a list";
    case Node::Kind::kMap:
      return "a map";
    default:
      return "a single value";
  }
}

std::string place_of(const Node& node) {
  return node.place().file + ":" + std::to_string(node.place().line);
}

// A value must have the kind of its default: a list, a map or a single value.
void check_kind(const Node& value, const Node& otherwise) {
  if (otherwise.kind() == Node::Kind::kNull || value.kind() == otherwise.kind()) return;
  value.fail(std::string("must be ") + word_for(otherwise.kind()) + ", as its default in " +
             place_of(otherwise));
}

// Reports a parameter without default that was not given.
[[noreturn]] void fail_missing(const Node& parameter, const std::string& name, const Node* asked_by) {
  if (!asked_by)
    parameter.fail(
        "has no default: give it a value with --parameters, or in the file that includes this one");
  asked_by->fail("parameter '" + name + "' is missing, it has no default in " + place_of(parameter));
}

// Checks the names of the parameters and that `given` names no others.
void check_names(const Node& block, const std::optional<Node>& given) {
  const auto names = block.keys();
  if (names.size() > kMaxParameters)
    block.fail("more than " + std::to_string(kMaxParameters) + " parameters");
  for (const std::string& name : names)
    if (const auto fault = config::variable_name_fault(name); !fault.empty())
      block.get(name).fail("'" + name + "' " + fault);
  if (given) given->allow_only({names.begin(), names.end()});
}

}  // namespace

IncludeEntry read_include(const Draft& draft, const Node& entry) {
  if (entry.kind() == Node::Kind::kScalar) return {read_path(entry), std::nullopt, draft.X_WO};
  entry.allow_only({"file", "parameters", "pose"});
  IncludeEntry wanted{read_path(entry.get("file")), entry.find("parameters"), draft.X_WO};
  if (entry.find("pose")) wanted.X_WO = read_world_pose(draft, entry, "pose");
  return wanted;
}

config::Variables read_parameters(const Node& root, const std::optional<Node>& given, const Node* asked_by,
                                  config::ExpansionBudget& budget) {
  config::Variables variables;
  const auto block = root.find("parameters");
  if (!block) {
    if (given) given->fail("'" + root.place().file + "' has no parameters");
    return variables;
  }
  check_names(*block, given);
  for (const std::string& name : block->keys()) {
    const Node otherwise = config::expanded(block->get(name), variables, budget);
    const auto value = given ? given->find(name) : std::nullopt;
    if (value) check_kind(*value, otherwise);
    if (!value && otherwise.kind() == Node::Kind::kNull) fail_missing(otherwise, name, asked_by);
    variables.emplace(name, value.value_or(otherwise));
  }
  return variables;
}

config::ConfigError told_where(const config::ConfigError& error, const fs::path& file, const Node& entry) {
  if (error.place().file != file.string()) return error;
  return {error.place(), error.message() + " (included from " + place_of(entry) + ")"};
}

void Includes::check(const fs::path& file, const Node& entry) const {
  std::error_code error;
  const fs::path canonical = config::identity_of(file);
  if (std::find(chain_.begin(), chain_.end(), canonical) != chain_.end()) {
    std::string chain;
    for (const fs::path& each : chain_) chain += each.filename().string() + " -> ";
    entry.fail("files include each other in a circle: " + chain + canonical.filename().string());
  }
  if (chain_.size() == kMaxIncludeDepth)
    entry.fail("files include each other more than " + std::to_string(kMaxIncludeDepth) + " levels deep");
  if (opened_ > kMaxIncludes) entry.fail("more than " + std::to_string(kMaxIncludes) + " files are included");
  if (!config::is_file(file) && !fs::is_directory(file, error))
    entry.fail("'" + file.string() + "': no such file");
}

Node Includes::open(const fs::path& file) {
  const fs::path canonical = config::identity_of(file);
  auto known = texts_.find(canonical);
  if (known == texts_.end()) known = texts_.emplace(canonical, config::load_file(file)).first;
  chain_.push_back(canonical);
  ++opened_;
  return known->second;
}

}  // namespace visum::scene
