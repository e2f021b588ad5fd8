// A group holds modules and other groups, and is a module itself for those outside. Edges carry values
// between the vectors of its members and its own border. Members are sorted into levels: in a cycle, Sense()
// goes up the levels and Control() goes down.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "clients/mca/module.h"

namespace visum::mca {

class Group : public Module {
 public:
  using Module::Module;

  // Makes a member: `add<Ramp>("Ramp")` calls Ramp(Place{this, "Ramp"}). The group owns it. Throws
  // std::invalid_argument if the name is taken.
  template <typename T, typename... Arguments>
  T& add(const std::string& name, Arguments&&... arguments) {
    auto made = std::make_unique<T>(Place{this, name}, std::forward<Arguments>(arguments)...);
    T& member = *made;
    keep(std::move(made));
    return member;
  }

  // An edge for the whole vector: both must have the same length. Or for a part of it. An edge goes
  //   down: from the group's controller input or a member's controller output, to a member's controller
  //   input or the group's controller output;
  //   up: from the group's sensor input or a member's sensor output, to a member's sensor input or the
  //   group's sensor output.
  // Several edges may leave one output. Throws std::invalid_argument if an edge cannot be.
  void AddEdge(Vector& from, Vector& to);
  void AddEdge(Vector& from, std::size_t first_from, Vector& to, std::size_t first_to, std::size_t count);

  const std::vector<std::unique_ptr<Module>>& members() const { return members_; }
  const std::vector<Edge>& edges() const { return edges_; }

  void Control() final;
  void Sense() final;

  // Sorts the members, of the groups in it as well. Members that stand in a cycle of edges or depend on one
  // are left out, and a line for each is put into `complaints`. To be called once all edges are there.
  void sort(std::vector<std::string>& complaints);

 private:
  void keep(std::unique_ptr<Module> member);
  bool owns(const Module* member) const;
  std::vector<Module*> sorted(VectorKind output, VectorKind input,
                              std::vector<std::string>& complaints) const;
  void carry_to(const Module* member, VectorKind kind) const;

  std::vector<std::unique_ptr<Module>> members_;
  std::vector<Edge> edges_;
  std::vector<Module*> down_, up_;  // in the order of their calls
};

}  // namespace visum::mca
