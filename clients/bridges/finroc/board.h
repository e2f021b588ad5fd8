// The tree of elements that peers see, with the ports' present values. Plain data on the bridge's one thread:
// the mapping fills it from the server's parts, and sessions read it. An element keeps its index for ever; a
// peer that comes later does not see the deleted ones.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "clients/bridges/finroc/values.h"

namespace visum::finroc {

using ElementId = std::uint32_t;  // an index into Board::elements()
inline constexpr ElementId kRoot = 0;
// Handles are indices times 4096: peers take the lower 12 bits for a stamp.
inline constexpr unsigned kStampBits = 12;
inline constexpr std::size_t kMostElements = 1u << 18;

constexpr std::int32_t handle_of(ElementId id) {
  return static_cast<std::int32_t>(id << kStampBits);
}

namespace flag {
inline constexpr std::uint32_t kPort = 1u << 0, kAggregator = 1u << 1, kInterface = 1u << 2,
                               kSensorData = 1u << 3, kControllerData = 1u << 4, kShared = 1u << 9,
                               kAcceptsData = 1u << 13, kEmitsData = 1u << 14, kReadOnly = 1u << 20,
                               kOutput = 1u << 21, kReady = 1u << 23, kPublished = 1u << 24,
                               kPushes = 1u << 30;
}

// How a peer may use a port.
enum class Access {
  kRead,   // an output: the bridge alone changes it
  kWrite,  // an input or a parameter: peers may change it
};

struct Element {
  std::string name;
  ElementId parent = kRoot;
  std::uint32_t flags = 0;
  std::vector<std::string> tags;
  bool deleted = false;

  // For ports.
  Type type;
  std::uint8_t unit = 0;
  Access access = Access::kRead;
  std::vector<ElementId> targets;  // edges that leave this port
  Value value;
  std::int64_t time_ns = 0;    // of the value, as Finroc counts: since 1970
  std::uint64_t revision = 0;  // grows with each change of the value

  bool is_port() const { return (flags & flag::kPort) != 0; }
};

class Board {
 public:
  // Changes a port on a peer's behalf. Returns why it was refused, or an empty text.
  using Write = std::function<std::string(ElementId, const Value&, const std::string& peer)>;

  Board();

  // Each adds an element and returns its id.
  ElementId add_group(ElementId parent, const std::string& name);
  ElementId add_module(ElementId parent, const std::string& name);
  ElementId add_plain(ElementId parent, const std::string& name);
  // An interface holds ports; `data` is flag::kSensorData, flag::kControllerData or 0.
  ElementId add_interface(ElementId parent, const std::string& name, std::uint32_t data);
  ElementId add_port(ElementId parent, const std::string& name, const Type& type, Access access,
                     const Value& initial, std::uint8_t unit = 0);
  ElementId add_administration(ElementId parent, const std::string& name);
  void add_edge(ElementId from, ElementId to);
  // Deletes an element with all below it.
  void remove(ElementId id);

  // Puts a new value into a port. Does nothing if it is the same.
  void set(ElementId id, const Value& value, std::int64_t time_ns);
  // Makes sessions send the value again though it has not changed: a peer's own write was refused.
  void send_again(ElementId id) { ++elements_[id].revision; }

  const std::vector<Element>& elements() const { return elements_; }
  bool is_living_port(ElementId id) const;
  std::string path(ElementId id) const;  // "/arm/Controller Input/Desired Angle 1"

  // The changes of the tree, in order, for sessions that have sent it already. New edges of an element
  // follow its creation.
  struct Change {
    enum class Kind { kCreated, kDeleted, kEdges } kind = Kind::kCreated;
    ElementId id = kRoot;
  };
  const std::vector<Change>& changes() const { return changes_; }

  Write write;              // set by the mapping
  std::int64_t now_ns = 0;  // likewise: the time of the first value of a new port

 private:
  ElementId add(Element element);

  std::vector<Element> elements_;
  std::vector<Change> changes_;
};

}  // namespace visum::finroc
