// Shows the server's parts on a board: names, types, values, and what peers write.
//
// A part is a module with the interfaces Controller Input, Sensor Output, Parameters and Blackboards, in a
// group that is called as the scene. Beside it stands the module Bridge, whose outputs say what was refused
// last.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "clients/bridges/common/cycle.h"
#include "clients/bridges/common/plant.h"
#include "clients/bridges/finroc/board.h"
#include "clients/bridges/finroc/controllers.h"

namespace visum::finroc {

class Mapping {
 public:
  // All must outlive this. With a cycle, what peers write acts at its end.
  Mapping(bridge::Plant& plant, Board& board, bridge::Cycle* cycle = nullptr);

  // Brings the values of all ports up to date. Parameters and blackboards are read again at most every half
  // second.
  void refresh(std::chrono::steady_clock::time_point now);

 private:
  enum class Source { kInput, kOutput, kParameter, kBoardText, kBoardNew };
  struct Link {
    Source source = Source::kInput;
    std::size_t part = 0, index = 0;
    std::string name;  // of a parameter or a blackboard
  };

  std::optional<ElementId> find_port(const std::string& part, protocol::ModuleVector vector,
                                     std::size_t index) const;
  void add_part(ElementId scene, std::size_t part);
  void add_ports(ElementId module, std::size_t part, Source source);
  void add_parameters(ElementId module, std::size_t part);
  void add_blackboards(ElementId module, std::size_t part);
  void refresh_settings();
  void refresh_parameters(std::size_t part);
  void refresh_blackboard(ElementId id, const Link& link);
  std::string write(ElementId id, const Value& value, const std::string& peer);
  std::string latch(ElementId id, const Link& link, const Value& value, const std::string& peer);
  std::string ask_for_steps(const Value& counter);
  void show_written(ElementId id, const Value& value);
  std::string note(ElementId id, const std::string& refusal);
  std::string write_to_plant(const Element& element, const Link& link, const Value& value);

  bridge::Plant& plant_;
  Board& board_;
  std::map<ElementId, Link> links_;
  bridge::Cycle* const cycle_;
  Controllers controllers_;
  ElementId last_refusal_ = kRoot, refusals_ = kRoot, time_ = kRoot, step_ = kRoot;
  std::int64_t refused_ = 0;
  std::optional<std::chrono::steady_clock::time_point> settings_read_;
};

}  // namespace visum::finroc
