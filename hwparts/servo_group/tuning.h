// The settings of a drive that clients may change as parameters while it runs: name, unit, bounds, and the
// check of a change. Serves virtual drives and real modules. Pure functions but for tune().
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
  const char* name;  // the parameter's name; the drive's number is appended
  const char* unit;  // "<u>" stands for rad or m
  const char* help;
  double drive::Tuning::*member;
  TuningRange (*range)(const drive::DriveData&, double tick_s);
  bool limit = false;                 // a soft limit: only limited drives have it
  std::uint8_t module_parameter = 0;  // id of a PowerCube module's parameter for it; 0: it has none
};
std::span<const TuningField> tuning_fields();

// The field as a parameter of drive `number` (counted from 1).
protocol::Parameter field_parameter(const TuningField& field, const drive::DriveData& data,
                                    const drive::Tuning& tuning, std::size_t number, double tick_s);
// Sets `field` of `tuning`. Returns the reason of a refusal, for an axis that stands at `position` [u];
// nothing if done.
std::optional<std::string> change(const TuningField& field, const drive::DriveData& data, double position,
                                  double value, double tick_s, drive::Tuning& tuning);

// Appends the parameters of drive `number` (counted from 1), then its readings: the winding's temperature and
// the gear's load.
void append_parameters(const drive::Drive& drive, std::size_t number, double tick_s,
                       std::vector<protocol::Parameter>& to);

// Sets `field` of a drive. Returns the reason of a refusal; nothing if done.
std::optional<std::string> tune(drive::Drive& drive, const TuningField& field, double value, double tick_s);

}  // namespace visum::servo_group
