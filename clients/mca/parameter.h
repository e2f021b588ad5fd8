// A setting of a module that can be changed while it runs, by tools or by the configuration file.
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "clients/cpp/visum.h"

namespace visum::protocol {
struct Parameter;  // part_description.h
}

namespace visum::mca {

class Module;

struct ParameterOptions {
  double minimum = -std::numeric_limits<double>::max();  // for numbers
  double maximum = std::numeric_limits<double>::max();
  std::string unit{}, help{};
  std::vector<std::string> choices{};  // for texts; empty: any text
};

class ParameterBase {
 public:
  // Throws std::invalid_argument if the module has a parameter of that name.
  ParameterBase(Module& module, std::string name, ParameterValue initial, ParameterOptions options);
  virtual ~ParameterBase() = default;
  ParameterBase(const ParameterBase&) = delete;
  ParameterBase& operator=(const ParameterBase&) = delete;

  const std::string& name() const { return name_; }
  const ParameterValue& value() const { return value_; }
  // Its description under the name "PATH NAME".
  protocol::Parameter description() const;
  // Returns why the value cannot be; empty: it is set. A whole number is taken where a number is wanted.
  std::string set(const ParameterValue& value);

 private:
  Module& module_;
  std::string name_;
  ParameterValue value_;
  ParameterOptions options_;
};

// T is double, std::int64_t, bool or std::string.
template <typename T>
class Parameter : public ParameterBase {
 public:
  Parameter(Module& module, std::string name, T initial, ParameterOptions options = {})
      : ParameterBase(module, std::move(name), ParameterValue(std::move(initial)), std::move(options)) {}
  const T& operator()() const { return std::get<T>(value()); }
};

}  // namespace visum::mca
