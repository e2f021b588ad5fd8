#include "clients/visum/run/search_spec.h"

#include <vector>

#include "protocol/config/unknown_name.h"

namespace visum::run {
namespace {

using config::Node;

// Names may be missing: a check is then called by what it measures, which is only known in a run.
std::vector<std::string> names_of_checks(const Node& root) {
  std::vector<std::string> names;
  const auto checks = root.find("checks");
  if (!checks || checks->kind() != Node::Kind::kList) return names;
  for (std::size_t i = 0; i < checks->size(); ++i) {
    const Node check = checks->at(i);
    if (check.kind() != Node::Kind::kMap) check.fail("must be a map");
    if (check.find("repeat")) check.fail("'search' cannot tell apart the checks of a 'repeat'");
    names.push_back(check.text_or("name", ""));
  }
  return names;
}

}  // namespace

std::optional<SearchSpec> read_search(const Node& root) {
  const auto node = root.find("search");
  if (!node) return std::nullopt;
  if (node->kind() != Node::Kind::kMap) node->fail("must be a map: {check: NAME, runs: 200}");
  node->allow_only({"check", "runs", "population", "seed", "until"});
  if (!root.find("sweep")) node->fail("needs a 'sweep' that names what is searched");
  const auto names = names_of_checks(root);
  if (names.empty()) node->fail("needs 'checks'");
  const auto wanted = node->find("check");
  if (!wanted && names.size() > 1) node->fail("needs 'check', the name of one of the checks");
  SearchSpec search;
  if (wanted) {
    while (search.check < names.size() && names[search.check] != wanted->text()) ++search.check;
    if (search.check == names.size()) wanted->fail(config::unknown_name("check", wanted->text(), names));
  }
  search.name = names[search.check];
  search.runs = static_cast<std::size_t>(node->get("runs").integer(1, 1'000'000));
  if (const auto size = node->find("population"))
    search.population = static_cast<std::size_t>(size->integer(4, 10'000));
  if (const auto seed = node->find("seed")) search.seed = static_cast<std::uint64_t>(seed->integer(0));
  if (const auto until = node->find("until"))
    search.until_broken = until->one_of({"broken", "runs"}) == "broken";
  return search;
}

}  // namespace visum::run
