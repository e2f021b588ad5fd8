// Shows the modules of controllers that clients have announced to the server: parts, groups and modules with
// their interfaces, parameters, values, edges and times. Below a part stand its blackboards. Belongs to the
// bridge's one thread.
//
// A peer that writes a parameter changes it in the module. The port shows what the module reports.
//
// A peer that writes a sensor input of a module makes it hold that value against its edge, for a test. The
// module's text `Held For Test` names what it holds; writing true to `Release Held` ends it.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "clients/bridges/common/plant.h"
#include "clients/bridges/finroc/board.h"
#include "protocol/module_messages.h"

namespace visum::finroc {

class Controllers {
 public:
  // Finds the port of a hardware part; nothing: there is none.
  using FindPort = std::function<std::optional<ElementId>(const std::string& part,
                                                          protocol::ModuleVector vector, std::size_t index)>;

  // All must outlive this.
  Controllers(bridge::Plant& plant, Board& board, FindPort find_hardware_port);

  // Brings the tree and all values up to date, at most every 40 ms.
  void refresh(std::chrono::steady_clock::time_point now, std::int64_t time_ns);

  // True: the port belongs to a module.
  bool owns(ElementId id) const {
    return inputs_.contains(id) || releases_.contains(id) || parameters_.contains(id);
  }
  // Returns why it is refused; empty: it is on its way.
  std::string write(ElementId id, const Value& value);

 private:
  static constexpr std::size_t kVectors = 4;
  // A module on the board. Ports of vector v: v's first id and those behind it.
  struct Shown {
    std::array<ElementId, kVectors> first{};
    std::array<std::size_t, kVectors> count{};
    ElementId first_parameter = kRoot;                                 // the others stand behind it
    ElementId held = kRoot, control_time = kRoot, sense_time = kRoot;  // of modules, not of groups
  };
  struct Place {
    std::string part, path, name;  // name: of a port or a parameter
  };

  void show(const protocol::ModuleList& list);
  void add_part(const protocol::AnnounceModules& announced);
  Shown add_module(ElementId element, const protocol::AnnounceModules& announced,
                   const protocol::ModuleDescription& module);
  void add_parameters(Shown& shown, ElementId element, const std::string& part,
                      const protocol::ModuleDescription& module);
  Type choice_or_text(const std::string& owner, const protocol::Parameter& parameter);
  void add_blackboards(ElementId top, const protocol::AnnounceModules& announced);
  void add_edges(const protocol::AnnounceModules& announced);
  std::optional<ElementId> port_of(const protocol::ModuleEnd& end, std::size_t offset) const;
  void set_values(const protocol::ModulePart& part, std::int64_t time_ns);
  void set_blackboards(const protocol::ModulePart& part, std::int64_t time_ns);

  bridge::Plant& plant_;
  Board& board_;
  const FindPort find_hardware_port_;
  std::uint64_t revision_ = 0;
  std::optional<std::chrono::steady_clock::time_point> refreshed_;
  std::vector<ElementId> roots_;                                // of the parts on the board
  std::map<std::string, std::vector<Shown>> shown_;             // by part: its modules, as announced
  std::map<std::string, protocol::AnnounceModules> announced_;  // by part
  std::map<ElementId, Place> inputs_;                           // sensor inputs of modules
  std::map<ElementId, Place> releases_;                         // their `Release Held`
  std::map<ElementId, Place> parameters_;                       // of modules and groups
  std::map<std::string, std::vector<ElementId>> boards_;        // by part: `read` of its blackboards
  std::map<std::string, std::vector<std::string>> choices_;  // by the name of a type; peers know it for ever
  std::map<std::string, std::vector<std::string>> held_;     // by part and path: names of ports
};

}  // namespace visum::finroc
