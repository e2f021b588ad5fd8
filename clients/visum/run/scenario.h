// A scenario as plain data: the programs to start, the actions and their times, the checks. SCENARIOS.md
// describes the file. Times are simulated seconds since the start, unless a name says wall. Places point into
// the file, for errors that show only once the world is known.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "clients/visum/run/coverage.h"
#include "clients/visum/run/overruns.h"
#include "protocol/config/config.h"

namespace visum::run {

// Something that can be measured. Which fields are used depends on the kind: see the table in quantity.cc.
struct QuantitySpec {
  std::string kind;  // "distance", "tilt", "port", ...
  std::string body;
  std::string other_body;     // distance, touching
  std::vector<double> point;  // distance: x y z in the world, instead of another body
  std::string axes;           // distance: "xyz", "xy", ...; position, tilt: one of x y z
  std::string joint;
  std::string part;
  std::string port;
  std::optional<std::uint64_t> mask;  // port: only these bits
  FloorSpec floor;                    // coverage
  config::Place place;                // of the quantity's own map
};

// The bounds of a measured value. At least one is given; all that are given must hold.
struct Bounds {
  std::optional<double> below;                       // value < below
  std::optional<double> above;                       // value > above
  std::optional<std::pair<double, double>> between;  // first <= value <= second
  std::optional<double> equals;                      // |value - equals| <= within
  double within = 0.0;
};

struct Condition {
  QuantitySpec quantity;
  Bounds bounds;
};

// The time in which a check must hold.
struct Window {
  enum class Kind {
    kEnd,         // at the last step
    kAlways,      // at every step from `from_s` to `to_s`
    kEventually,  // at one step at least, until `to_s`
  };
  Kind kind = Kind::kEnd;
  double from_s = 0.0;
  double to_s = std::numeric_limits<double>::infinity();
};

struct CheckSpec {
  std::string name;
  Condition that;
  Window when;
};

struct ControllerSpec {
  std::string name;
  std::vector<std::string> command;  // with its placeholders
  std::string client;                // the name that it says hello with
  std::optional<bool> joins;         // the clock; not given: under lockstep
  bool shim = false;                 // under lockstep its time is the world's (visum exec --lockstep)
  std::string gate;                  // under lockstep its cycles let the world run (visum exec --gate)
  double period_ms = 0.0;            // of --period, with shim or gate; 0: not given
  double wait_s = 0.0;               // of --wait
  std::string on_timeout = "end";    // of --on-timeout
  bool exchanges = true;             // the run claims that it exchanges something with a part
  std::string through;               // the controller that exchanges it on its behalf; empty: itself
  config::Place place;
};

// ---------------------------------------------------------------------------------------------- the time
// line

struct SetPort {
  std::string part, port;
  double value = 0.0;
  bool take = false;  // the lease from its holder
};
struct Push {
  std::string body;
  std::vector<double> force_n, torque_nm, point_m;
  double duration_s = 0.1;
};
struct SetParameter {
  std::string part, name;
  std::string value;  // as written; the parameter's own type decides what it means
};
struct InjectFault {
  std::string part, kind;
  std::vector<std::pair<std::string, double>> numbers;
  double duration_s = 0.0;  // 0: until it is cleared
};
struct ClearFault {
  std::string part, kind;  // kind: empty: all
  int joint = 0;           // 0: of all
};
struct Signal {
  std::string controller;
  int number = 0;
};
struct RemoveBody {
  std::string body;
};
struct Say {
  std::string text;
};
using Action = std::variant<SetPort, Push, SetParameter, InjectFault, ClearFault, Signal, RemoveBody, Say>;

struct TimelineEntry {
  double at_s = 0.0;              // where there is no condition
  std::optional<Condition> when;  // at the first step at which it holds
  Action action;
  config::Place place;
};

// ---------------------------------------------------------------------------------------------- the whole

struct Until {
  enum class Kind { kControllers, kTime, kCondition };
  Kind kind = Kind::kControllers;  // all have left and ended
  double at_s = 0.0;
  std::optional<Condition> condition;
};

struct Scenario {
  std::filesystem::path file, scene;
  std::string name;
  std::string clock = "lockstep";
  std::optional<std::string> engine;
  std::optional<std::int64_t> seed;
  std::string parameters;  // of the scene, a YAML map on one line; empty: its defaults
  // Where it is one of the runs of a sweep: which one, from 1, and by which values, for people.
  std::size_t run = 0;
  std::vector<std::pair<std::string, std::string>> swept;
  std::string record;                        // a recording's file; empty: none
  bool record_if_possible = false;           // a recording that cannot be written is no failure
  std::map<std::string, std::string> buses;  // kind by part: "pty", "tcp", "slcan"
  double speedup = 0.0;                      // simulated per wall seconds; 0: the scene's, in lockstep none
  double max_overruns = kMostOverruns;       // of all ticks, in real time; more make the run invalid
  double max_sim_s = 60.0;
  double max_wall_s = 300.0;
  double start_wall_s = 10.0;  // for daemon and controllers to be ready
  double check_every_ms = 10.0;
  double settle_s = 0.0;  // from the end of `until` to the end
  Until until;
  std::vector<ControllerSpec> controllers;
  std::vector<TimelineEntry> timeline;
  std::vector<CheckSpec> checks;
};

}  // namespace visum::run
