// Enumerations that name the ports of a module, and the natural names of the ports: "eCI_DESIRED_ANGLE_1" is
// shown as "Desired Angle 1". Pure functions.
#pragma once

#include <string>
#include <string_view>
#include <vector>

// Each declares the enumeration of one vector in a module, group or part. The last enumerator ends with
// _DIMENSION and is the length of the vector; no enumerator has a value of its own.
#define MCA_CONTROLLER_INPUT(...)                 \
  enum ControllerInputPort : int { __VA_ARGS__ }; \
  static constexpr const char* kControllerInputs = #__VA_ARGS__
#define MCA_CONTROLLER_OUTPUT(...)                 \
  enum ControllerOutputPort : int { __VA_ARGS__ }; \
  static constexpr const char* kControllerOutputs = #__VA_ARGS__
#define MCA_SENSOR_INPUT(...)                 \
  enum SensorInputPort : int { __VA_ARGS__ }; \
  static constexpr const char* kSensorInputs = #__VA_ARGS__
#define MCA_SENSOR_OUTPUT(...)                 \
  enum SensorOutputPort : int { __VA_ARGS__ }; \
  static constexpr const char* kSensorOutputs = #__VA_ARGS__

namespace visum::mca {

// "eSO_ACTUAL_ANGLE_1" becomes "Actual Angle 1". Throws std::invalid_argument if there is no prefix.
std::string natural_name(std::string_view enumerator);

// The natural names of a list of enumerators as it stands in the source, without the last one. Throws
// std::invalid_argument if one has a value, or if the last does not end with _DIMENSION.
std::vector<std::string> port_names(std::string_view enumerators);

// The names of the four vectors of a module.
struct PortNames {
  std::vector<std::string> controller_inputs{}, controller_outputs{}, sensor_inputs{}, sensor_outputs{};
};

// The names that the macros above have declared in T. A vector without a declaration has no ports.
template <typename T>
PortNames ports() {
  PortNames names;
  if constexpr (requires { T::kControllerInputs; })
    names.controller_inputs = port_names(T::kControllerInputs);
  if constexpr (requires { T::kControllerOutputs; })
    names.controller_outputs = port_names(T::kControllerOutputs);
  if constexpr (requires { T::kSensorInputs; }) names.sensor_inputs = port_names(T::kSensorInputs);
  if constexpr (requires { T::kSensorOutputs; }) names.sensor_outputs = port_names(T::kSensorOutputs);
  return names;
}

}  // namespace visum::mca
