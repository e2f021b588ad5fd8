#include "clients/bridges/finroc/board.h"

#include <stdexcept>

namespace visum::finroc {
namespace {

constexpr std::uint32_t kLiving = flag::kReady | flag::kPublished;

}  // namespace

Board::Board() {
  elements_.emplace_back();  // the root, which is never sent
}

ElementId Board::add(Element element) {
  if (elements_.size() >= kMostElements) throw std::length_error("too many elements for Finroc's handles");
  const auto id = static_cast<ElementId>(elements_.size());
  element.flags |= kLiving;
  elements_.push_back(std::move(element));
  changes_.push_back({Change::Kind::kCreated, id});
  return id;
}

ElementId Board::add_group(ElementId parent, const std::string& name) {
  return add({.name = name, .parent = parent, .tags = {"group"}});
}

ElementId Board::add_module(ElementId parent, const std::string& name) {
  return add({.name = name, .parent = parent, .tags = {"module"}});
}

ElementId Board::add_plain(ElementId parent, const std::string& name) {
  return add({.name = name, .parent = parent});
}

ElementId Board::add_interface(ElementId parent, const std::string& name, std::uint32_t data) {
  return add({.name = name, .parent = parent, .flags = flag::kAggregator | flag::kInterface | data});
}

ElementId Board::add_port(ElementId parent, const std::string& name, const Type& type, Access access,
                          const Value& initial, std::uint8_t unit) {
  const std::uint32_t direction = access == Access::kRead ? flag::kEmitsData | flag::kOutput | flag::kReadOnly
                                                          : flag::kAcceptsData | flag::kPushes;
  return add({.name = name,
              .parent = parent,
              .flags = flag::kPort | flag::kShared | direction,
              .type = type,
              .unit = unit,
              .access = access,
              .value = initial,
              .time_ns = now_ns});
}

ElementId Board::add_administration(ElementId parent, const std::string& name) {
  return add({.name = name,
              .parent = parent,
              .flags = flag::kPort | flag::kAcceptsData,
              .type = {Kind::kAdministration, "Administration Interface", {}},
              .access = Access::kWrite});
}

void Board::add_edge(ElementId from, ElementId to) {
  elements_.at(from).targets.push_back(to);
  if (changes_.empty() || changes_.back().kind != Change::Kind::kEdges || changes_.back().id != from)
    changes_.push_back({Change::Kind::kEdges, from});
}

void Board::remove(ElementId id) {
  if (id == kRoot || elements_.at(id).deleted) return;
  for (ElementId child = id + 1; child < elements_.size(); ++child) {  // a child is younger than its parent
    if (elements_[child].parent == id) remove(child);
  }
  elements_[id].deleted = true;
  changes_.push_back({Change::Kind::kDeleted, id});
}

void Board::set(ElementId id, const Value& value, std::int64_t time_ns) {
  Element& element = elements_[id];
  if (element.value == value) return;
  element.value = value;
  element.time_ns = time_ns;
  ++element.revision;
}

bool Board::is_living_port(ElementId id) const {
  return id != kRoot && id < elements_.size() && elements_[id].is_port() && !elements_[id].deleted;
}

std::string Board::path(ElementId id) const {
  std::string path;
  for (; id != kRoot; id = elements_[id].parent) path = "/" + elements_[id].name + path;
  return path;
}

}  // namespace visum::finroc
