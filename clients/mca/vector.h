// One of the four vectors of a module: numbers with names, and what is known of their changes. Belongs to one
// Module, on the thread of the part's loop.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace visum::protocol {
enum class ModuleVector : std::uint32_t;  // module_messages.h
}

namespace visum::mca {

using VectorKind = protocol::ModuleVector;

class Module;

class Vector {
 public:
  // `owner` is null for a vector of another part.
  Vector(VectorKind kind, const Module* owner, std::vector<std::string> names)
      : kind_(kind), owner_(owner), names_(std::move(names)), values_(names_.size()), seen_(names_.size()) {}
  Vector(const Vector&) = delete;
  Vector& operator=(const Vector&) = delete;

  VectorKind kind() const { return kind_; }
  const Module* owner() const { return owner_; }
  std::size_t size() const { return values_.size(); }
  const std::vector<std::string>& names() const { return names_; }
  const std::vector<double>& values() const { return values_; }
  // The index of a port by its natural name. Throws std::invalid_argument with the nearest names.
  std::size_t index_of(const std::string& name) const;

  // Throws std::out_of_range beyond the vector.
  double& at(std::size_t index) { return values_.at(index); }
  double at(std::size_t index) const { return values_.at(index); }

  // True if a value differs from the one at the last look, or if nobody has looked yet.
  bool changed() const;
  bool changed(std::size_t index) const { return !looked_ || differs(index); }
  // From now on changes are counted anew.
  void look();

  // Makes a port hold a value, whatever its edge brings, until it is released.
  void hold(std::size_t index, double value) { held_[index] = value; }
  void release(std::size_t index) { held_.erase(index); }
  const std::map<std::size_t, double>& held() const { return held_; }
  // Puts the held values in. To be called once edges have brought theirs.
  void keep_held();

 private:
  bool differs(std::size_t index) const;

  VectorKind kind_;
  const Module* owner_;
  std::vector<std::string> names_;
  std::vector<double> values_, seen_;
  bool looked_ = false;
  std::map<std::size_t, double> held_;
};

// Carries `count` values from one vector to another, each time before the receiver works on them.
struct Edge {
  Vector* from;
  std::size_t first_from;
  Vector* to;
  std::size_t first_to;
  std::size_t count;

  void carry() const;
};

}  // namespace visum::mca
