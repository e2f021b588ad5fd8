#include "clients/mca/group.h"
#include "protocol/module_messages.h"

#include <algorithm>
#include <stdexcept>

namespace visum::mca {
namespace {

std::string text_of(const Vector& vector) {
  const std::string owner = vector.owner() == nullptr ? "another part" : vector.owner()->path();
  return "the " + std::string(protocol::to_string(vector.kind())) + " of " +
         (owner.empty() ? "the part" : "'" + owner + "'");
}

[[noreturn]] void refuse(const Vector& from, const Vector& to, const std::string& why) {
  throw std::invalid_argument("no edge can go from " + text_of(from) + " to " + text_of(to) + ": " + why);
}

bool goes_down(const Vector& vector) {
  return vector.kind() == VectorKind::kControllerInput || vector.kind() == VectorKind::kControllerOutput;
}

}  // namespace

void Group::keep(std::unique_ptr<Module> member) {
  for (const auto& other : members_)
    if (other->name() == member->name())
      throw std::invalid_argument("'" + path() + "' has two members '" + member->name() + "'");
  members_.push_back(std::move(member));
}

bool Group::owns(const Module* member) const {
  return std::ranges::any_of(members_, [&](const auto& own) { return own.get() == member; });
}

void Group::AddEdge(Vector& from, Vector& to) {
  if (from.size() != to.size())
    refuse(from, to,
           "they have " + std::to_string(from.size()) + " and " + std::to_string(to.size()) + " ports");
  AddEdge(from, 0, to, 0, from.size());
}

void Group::AddEdge(Vector& from, std::size_t first_from, Vector& to, std::size_t first_to,
                    std::size_t count) {
  const bool down = goes_down(from);
  if (down != goes_down(to)) refuse(from, to, "one goes down and the other up");
  const VectorKind output = down ? VectorKind::kControllerOutput : VectorKind::kSensorOutput;
  const VectorKind input = down ? VectorKind::kControllerInput : VectorKind::kSensorInput;
  const bool begins_well =
      (from.owner() == this && from.kind() == input) || (owns(from.owner()) && from.kind() == output);
  const bool ends_well =
      (to.owner() == this && to.kind() == output) || (owns(to.owner()) && to.kind() == input);
  if (!begins_well) refuse(from, to, "it must begin at an output of a member, or at the group's border");
  if (!ends_well) refuse(from, to, "it must end at an input of a member, or at the group's border");
  const auto fits = [count](const Vector& vector, std::size_t first) {
    return first <= vector.size() && count <= vector.size() - first;
  };
  if (!fits(from, first_from) || !fits(to, first_to)) refuse(from, to, "it goes beyond the vector");
  edges_.push_back({&from, first_from, &to, first_to, count});
}

// The members in an order in which each comes after those whose outputs it takes.
std::vector<Module*> Group::sorted(VectorKind output, VectorKind input,
                                   std::vector<std::string>& complaints) const {
  std::vector<Module*> order;
  std::vector<Module*> left;
  for (const auto& member : members_) left.push_back(member.get());
  const auto waits = [&](const Module* member) {
    return std::ranges::any_of(edges_, [&](const Edge& edge) {
      return edge.to->owner() == member && edge.to->kind() == input && edge.from->kind() == output &&
             std::ranges::find(left, edge.from->owner()) != left.end();
    });
  };
  for (auto next = left.begin(); next != left.end();) {
    next = std::ranges::find_if_not(left, waits);
    if (next == left.end()) break;
    order.push_back(*next);
    left.erase(next);
    next = left.begin();
  }
  for (const Module* member : left)
    complaints.push_back("'" + member->path() + "' is left out of the " +
                         (output == VectorKind::kControllerOutput ? "control" : "sense") +
                         ": it stands in a cycle of edges, or depends on one");
  return order;
}

void Group::sort(std::vector<std::string>& complaints) {
  down_ = sorted(VectorKind::kControllerOutput, VectorKind::kControllerInput, complaints);
  up_ = sorted(VectorKind::kSensorOutput, VectorKind::kSensorInput, complaints);
  for (const auto& member : members_)
    if (auto* group = dynamic_cast<Group*>(member.get())) group->sort(complaints);
}

void Group::carry_to(const Module* member, VectorKind kind) const {
  for (const Edge& edge : edges_)
    if (edge.to->owner() == member && edge.to->kind() == kind) edge.carry();
}

void Group::Control() {
  for (Module* member : down_) {
    carry_to(member, VectorKind::kControllerInput);
    member->run_control();
  }
  carry_to(this, VectorKind::kControllerOutput);
}

void Group::Sense() {
  for (Module* member : up_) {
    carry_to(member, VectorKind::kSensorInput);
    member->sensor_input().keep_held();
    member->run_sense();
  }
  carry_to(this, VectorKind::kSensorOutput);
}

}  // namespace visum::mca
