#include "clients/visum/compare/recordings.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "protocol/config/config.h"
#include "protocol/recording/recording_file.h"

namespace visum::compare {
namespace {

using recording::RecordingFile;

// A recording, read up to one tick after the other.
class Side {
 public:
  explicit Side(const std::filesystem::path& file) : name_(file.string()), file_(file) {}

  const recording::Header& header() const { return file_.header(); }
  // Goes on to the next tick. Returns false at the end.
  bool next() {
    for (auto item = file_.next(); !std::holds_alternative<RecordingFile::End>(item); item = file_.next()) {
      if (const auto* part = std::get_if<const protocol::PartDescription*>(&item)) describe(**part);
      if (const auto* sample = std::get_if<const protocol::PartSample*>(&item)) keep(**sample);
      if (const auto* tick = std::get_if<const recording::Tick*>(&item)) {
        now_ = **tick;
        ++ticks_;
        return true;
      }
    }
    if (!file_.damage().empty()) throw config::ConfigError({name_, 0, ""}, file_.damage());
    return false;
  }

  const recording::Tick& now() const { return now_; }  // but for its fault
  std::uint64_t ticks() const { return ticks_; }
  const std::vector<std::string>& ports() const { return ports_; }
  const std::vector<double>& values() const { return values_; }

 private:
  struct Place {
    std::size_t inputs = 0, input_count = 0, outputs = 0, output_count = 0;
  };

  void describe(const protocol::PartDescription& part) {
    Place place;
    const auto add = [&](const std::vector<protocol::Port>& ports, std::size_t& first, std::size_t& count) {
      first = ports_.size();
      count = ports.size();
      for (const auto& port : ports) ports_.push_back(part.name + "/" + port.name);
    };
    add(part.controller_inputs, place.inputs, place.input_count);
    add(part.sensor_outputs, place.outputs, place.output_count);
    places_[part.name] = place;
    values_.resize(ports_.size(), std::numeric_limits<double>::quiet_NaN());
  }

  void keep(const protocol::PartSample& sample) {
    const auto found = places_.find(sample.part);
    if (found == places_.end()) return;
    const Place& place = found->second;
    std::copy_n(sample.controller_inputs.begin(),
                std::min(place.input_count, sample.controller_inputs.size()),
                values_.begin() + static_cast<std::ptrdiff_t>(place.inputs));
    std::copy_n(sample.sensor_outputs.begin(), std::min(place.output_count, sample.sensor_outputs.size()),
                values_.begin() + static_cast<std::ptrdiff_t>(place.outputs));
  }

  std::string name_;
  RecordingFile file_;
  std::map<std::string, Place> places_;
  std::vector<std::string> ports_;
  std::vector<double> values_;
  recording::Tick now_;
  std::uint64_t ticks_ = 0;
};

bool same(double a, double b) {
  return a == b || (std::isnan(a) && std::isnan(b));
}

class Comparer {
 public:
  Comparer(const std::filesystem::path& a, const std::filesystem::path& b) : a_(a), b_(b) {}

  RecordingComparison go() {
    compare_settings();
    bool more_a = a_.next(), more_b = b_.next();
    pair_ports();
    for (; more_a && more_b; more_a = a_.next(), more_b = b_.next()) compare_tick();
    if (more_a != more_b) part_at((more_a ? a_ : b_).now().tick);
    while (more_a) more_a = a_.next();
    while (more_b) more_b = b_.next();
    result_.ticks_a = a_.ticks();
    result_.ticks_b = b_.ticks();
    for (auto& pair : pairs_)
      if (pair.differs) result_.ports.push_back(std::move(pair.distance));
    result_.equal = !result_.first_tick && result_.only_a.empty() && result_.only_b.empty();
    return std::move(result_);
  }

 private:
  struct Pair {
    std::size_t a = 0, b = 0;
    bool differs = false;
    PortDistance distance;
  };

  // Different ticks have no common times, and no port could be compared.
  void compare_settings() {
    const auto &a = a_.header(), &b = b_.header();
    const auto note = [&](const std::string& what, const std::string& one, const std::string& other) {
      if (one != other) result_.settings.push_back(what + ": " + one + ", " + other);
    };
    const auto engine = [](const recording::Header& header) {
      if (!header.engine.empty()) return header.engine;
      std::string all;
      for (const auto& name : header.build.engines) all += (all.empty() ? "" : "+") + name;
      return all;
    };
    note("scene", a.scene, b.scene);
    note("engine", engine(a), engine(b));
    note("seed", std::to_string(a.seed), std::to_string(b.seed));
    note("parameters", a.parameters, b.parameters);
    note("tick in ns", std::to_string(a.tick_ns), std::to_string(b.tick_ns));
    note("version", a.build.version + " " + a.build.commit, b.build.version + " " + b.build.commit);
    note("compiler", a.build.compiler, b.build.compiler);
    std::map<std::string, std::uint32_t> crcs;
    for (const auto& file : a.files) crcs[std::filesystem::path(file.name).filename()] = file.crc;
    for (const auto& file : b.files) {
      const auto found = crcs.find(std::filesystem::path(file.name).filename());
      if (found != crcs.end() && found->second != file.crc)
        result_.settings.push_back("file " + found->first + ": not the same content");
    }
    if (a.tick_ns != b.tick_ns)
      throw config::ConfigError({}, "their ticks have different lengths (" + std::to_string(a.tick_ns) +
                                        " and " + std::to_string(b.tick_ns) +
                                        " ns), so no tick of one is one of the other");
  }

  void pair_ports() {
    std::map<std::string, std::size_t> in_b;
    for (std::size_t i = 0; i < b_.ports().size(); ++i) in_b.emplace(b_.ports()[i], i);
    for (std::size_t i = 0; i < a_.ports().size(); ++i) {
      const auto found = in_b.find(a_.ports()[i]);
      if (found == in_b.end()) {
        result_.only_a.push_back(a_.ports()[i]);
        continue;
      }
      pairs_.push_back({i, found->second, false, {}});
      pairs_.back().distance.port = a_.ports()[i];
      in_b.erase(found);
    }
    for (const auto& port : b_.ports())
      if (in_b.count(port) != 0) result_.only_b.push_back(port);
  }

  void part_at(std::int64_t tick) {
    if (!result_.first_tick) result_.first_tick = tick;
  }

  void compare_tick() {
    const auto &a = a_.now(), &b = b_.now();
    const bool hashed = a.state_hash != recording::kNoHash && b.state_hash != recording::kNoHash;
    if (a.tick != b.tick || a.era != b.era || (hashed && a.state_hash != b.state_hash)) part_at(a.tick);
    for (Pair& pair : pairs_) {
      const double one = a_.values()[pair.a], other = b_.values()[pair.b];
      PortDistance& distance = pair.distance;
      const double at_s = static_cast<double>(a_.ticks()) * static_cast<double>(a_.header().tick_ns) / 1e9;
      distance.course_a.add(at_s, one);
      distance.course_b.add(at_s, other);
      if (same(one, other)) continue;
      part_at(a.tick);
      if (!pair.differs) {
        pair.differs = true;
        distance.tick = a.tick;
        distance.first_s = at_s;
        distance.a = one;
        distance.b = other;
      }
      double apart = std::abs(one - other);
      if (std::isnan(apart)) apart = std::numeric_limits<double>::infinity();
      if (apart <= distance.max_abs) continue;
      distance.max_abs = apart;
      distance.max_tick = a.tick;
    }
  }

  Side a_, b_;
  std::vector<Pair> pairs_;
  RecordingComparison result_;
};

}  // namespace

RecordingComparison compare_recordings(const std::filesystem::path& a, const std::filesystem::path& b) {
  return Comparer(a, b).go();
}

}  // namespace visum::compare
