// Reads two recordings tick by tick and tells where they differ: `visum compare`, and a recording that the
// page shows beside another one. A tick of one is compared with the same tick of the other, counted from the
// beginning. Ports are compared bit for bit, the state where both hold its hash, or all of it. Any one
// thread.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "protocol/recording/recording_file.h"

namespace visum::recording {

class RecordingPair {
 public:
  struct Moment {
    std::uint64_t position = 0;  // ticks since the beginning of the recordings
    std::int64_t tick = 0;       // of the world
  };

  // A port that both have.
  struct Port {
    std::string part, name;
    double a = std::numeric_limits<double>::quiet_NaN();  // its values in the tick that was read last
    double b = std::numeric_limits<double>::quiet_NaN();
    std::optional<Moment> first;  // where it first differed; none: it is the same so far
    double first_a = 0.0, first_b = 0.0;
    double max_abs = 0.0;  // so far; infinity where one is no number
    std::int64_t max_tick = 0;
  };

  // Throws config::ConfigError where a file is no recording, and where their ticks have different lengths, so
  // that no tick of one is a tick of the other.
  RecordingPair(const std::filesystem::path& a, const std::filesystem::path& b);

  // Reads the next tick of each, and compares them. Returns false when both have ended; one may end sooner.
  // Throws config::ConfigError where a file is damaged.
  bool next();

  bool both() const { return a_.is_there && b_.is_there; }  // both have the tick that was read last
  std::uint64_t ticks_a() const { return a_.ticks; }        // read so far
  std::uint64_t ticks_b() const { return b_.ticks; }
  // The first tick that differs, or that one of them lacks; none: there is no such tick so far.
  const std::optional<Moment>& first() const { return first_; }
  // Simulated seconds from the beginning to that many ticks.
  double seconds(std::uint64_t ticks) const;

  const std::vector<Port>& ports() const { return ports_; }           // in the order of A
  const std::vector<std::string>& only_a() const { return only_a_; }  // ports, "arm/Actual Angle 1"
  const std::vector<std::string>& only_b() const { return only_b_; }
  // How the worlds were made differently: "engine: impulse, ode".
  const std::vector<std::string>& settings() const { return settings_; }
  // False: the files of the scene are not the same in both; settings() names them.
  bool same_files() const { return same_files_; }

 private:
  // Where the ports of a part are in Side::values.
  struct Place {
    std::size_t inputs = 0, input_count = 0, outputs = 0, output_count = 0;
  };
  struct Name {
    std::string part, port;
  };
  struct Whole {
    Moment at;  // the tick that it stands behind
    std::uint64_t inputs = 0;
    std::vector<std::byte> state;
  };
  struct Side {
    explicit Side(const std::filesystem::path& of);
    bool next();
    void describe(const protocol::PartDescription& part);
    void keep(const protocol::PartSample& sample);

    std::string file_name;
    RecordingFile file;
    std::map<std::string, Place> places;  // by part
    std::vector<Name> names;
    std::vector<double> values;
    Tick now;                    // but for its fault
    std::optional<Whole> whole;  // the one that was read last and not compared yet
    std::uint64_t ticks = 0, inputs = 0;
    bool is_there = true;
  };

  void compare_settings();
  void compare_files();
  void pair_ports();
  void differ();          // in this tick
  void compare_states();  // those that stand behind the same ticks and as many inputs
  void compare_ports();

  Side a_, b_;
  std::vector<Port> ports_;
  std::vector<std::pair<std::size_t, std::size_t>> places_;  // by port: in the values of A and of B
  std::vector<std::string> only_a_, only_b_, settings_;
  bool same_files_ = true;
  std::optional<Moment> first_;
};

}  // namespace visum::recording
