#include "clients/bridges/finroc/records.h"

namespace visum::finroc {
namespace {

constexpr std::uint8_t kOneLink = 1, kPortMark = 0x80;
constexpr std::int16_t kUsualInterval = -1;
constexpr bool kNotUnique = false, kOneType = true, kByFinstruct = false;
constexpr std::size_t kMostEdges = 254;  // 255 in place of their number means something else

void put_links(Writer& out, const Board& board, ElementId id, Structure wants) {
  const Element& element = board.elements()[id];
  if (wants == Structure::kSharedPorts) {
    out.put(kOneLink).put_string(board.path(id).substr(1)).put_bool(kNotUnique);
    return;
  }
  out.put(static_cast<std::uint8_t>(element.is_port() ? kOneLink | kPortMark : kOneLink));
  out.put_string(element.name).put_bool(kNotUnique).put(handle_of(element.parent));
}

void put_port(Writer& out, const Element& element) {
  // An input's strategy is 1, "push": fingui never sends to an input that has 0.
  const std::int16_t strategy = (element.flags & flag::kPushes) != 0 ? 1 : 0;
  out.put(element.flags).put(strategy).put(kUsualInterval);
}

void put_edges(Writer& out, const Board& board, const Element& element) {
  std::vector<ElementId> targets;
  for (const ElementId target : element.targets) {
    if (board.is_living_port(target) && targets.size() < kMostEdges) targets.push_back(target);
  }
  out.put(static_cast<std::uint8_t>(targets.size()));
  for (const ElementId target : targets) out.put(handle_of(target)).put_bool(kByFinstruct);
}

void put_tags(Writer& out, const Element& element) {
  out.put_bool(!element.tags.empty());
  if (element.tags.empty()) return;
  out.put(static_cast<std::uint32_t>(element.tags.size())).put_bool(kOneType);
  for (const std::string& tag : element.tags) out.put_string(tag);
}

}  // namespace

bool is_shown(const Board& board, ElementId id, Structure wants) {
  const Element& element = board.elements()[id];
  if (id == kRoot || element.deleted || wants == Structure::kNone) return false;
  return wants != Structure::kSharedPorts || (element.flags & flag::kShared) != 0;
}

void put_changed_port(Writer& out, const Board& board, ElementId id) {
  const Element& element = board.elements()[id];
  out.put(handle_of(id));
  put_port(out, element);
  put_edges(out, board, element);
}

void put_record(Writer& out, const Board& board, ElementId id, Structure wants, TypesSent& types) {
  const Element& element = board.elements()[id];
  out.put(handle_of(id));
  put_links(out, board, id, wants);
  if (element.is_port()) {
    types.put(out, element.type);
    put_port(out, element);
  } else {
    out.put(element.flags);
  }
  if (wants != Structure::kFinstruct) return;
  if (element.is_port()) put_edges(out, board, element);
  put_tags(out, element);
}

}  // namespace visum::finroc
