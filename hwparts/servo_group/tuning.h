// The parameters of a drive that a lab may change while it runs: name, unit, bounds, and how a change is
// checked.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "hwparts/drive/drive.h"
#include "protocol/part_description.h"

namespace visum::servo_group {

struct TuningRange {
  double minimum;
  double maximum;
};

struct TuningField {
  const char* name;  // the port-like name, to be followed by the drive's number
  const char* unit;  // "<u>" stands for rad or m
  const char* help;
  double drive::Tuning::*member;
  TuningRange (*range)(const drive::DriveData&, double tick_s);
  bool limit = false;                 // a soft limit: of limited drives only
  std::uint8_t module_parameter = 0;  // the same number of a PowerCube module; 0: it has none
};
std::span<const TuningField> tuning_fields();

// One field as a parameter of drive `number` (from 1).
protocol::Parameter field_parameter(const TuningField& field, const drive::DriveData& data,
                                    const drive::Tuning& tuning, std::size_t number, double tick_s);
// `tuning` with another value in `field`: why not, for an axis that stands at `position` [u].
std::optional<std::string> change(const TuningField& field, const drive::DriveData& data, double position,
                                  double value, double tick_s, drive::Tuning& tuning);

// Those of drive `number` (from 1), with what can only be read at their end: the winding's temperature, the
// gear's load.
void append_parameters(const drive::Drive& drive, std::size_t number, double tick_s,
                       std::vector<protocol::Parameter>& to);

// Sets `field`; returns why not.
std::optional<std::string> tune(drive::Drive& drive, const TuningField& field, double value, double tick_s);

}  // namespace visum::servo_group
