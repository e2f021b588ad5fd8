#include "protocol/recording/recording_pair.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "protocol/config/config.h"

namespace visum::recording {
namespace {

bool same(double a, double b) {
  return a == b || (std::isnan(a) && std::isnan(b));
}

std::string engine_of(const Header& header) {
  if (!header.engine.empty()) return header.engine;
  std::string all;
  for (const auto& name : header.build.engines) all += (all.empty() ? "" : "+") + name;
  return all;
}

}  // namespace

RecordingPair::Side::Side(const std::filesystem::path& of) : file_name(of.string()), file(of) {}

bool RecordingPair::Side::next() {
  for (auto item = file.next(); !std::holds_alternative<RecordingFile::End>(item); item = file.next()) {
    if (const auto* part = std::get_if<const protocol::PartDescription*>(&item)) describe(**part);
    if (const auto* sample = std::get_if<const protocol::PartSample*>(&item)) keep(**sample);
    if (std::holds_alternative<const TimedInput*>(item)) ++inputs;
    if (const auto* state = std::get_if<const State*>(&item))
      whole = {{ticks, (*state)->tick}, inputs, (*state)->state};
    if (const auto* tick = std::get_if<const Tick*>(&item)) {
      now = **tick;
      ++ticks;
      return true;
    }
  }
  if (!file.damage().empty()) throw config::ConfigError({file_name, 0, ""}, file.damage());
  return false;
}

void RecordingPair::Side::describe(const protocol::PartDescription& part) {
  Place place;
  const auto add = [&](const std::vector<protocol::Port>& ports, std::size_t& first, std::size_t& count) {
    first = names.size();
    count = ports.size();
    for (const auto& port : ports) names.push_back({part.name, port.name});
  };
  add(part.controller_inputs, place.inputs, place.input_count);
  add(part.sensor_outputs, place.outputs, place.output_count);
  places[part.name] = place;
  values.resize(names.size(), std::numeric_limits<double>::quiet_NaN());
}

void RecordingPair::Side::keep(const protocol::PartSample& sample) {
  const auto found = places.find(sample.part);
  if (found == places.end()) return;
  const auto copy = [&](const std::vector<double>& from, std::size_t first, std::size_t count) {
    std::copy_n(from.begin(), std::min(count, from.size()),
                values.begin() + static_cast<std::ptrdiff_t>(first));
  };
  copy(sample.controller_inputs, found->second.inputs, found->second.input_count);
  copy(sample.sensor_outputs, found->second.outputs, found->second.output_count);
}

RecordingPair::RecordingPair(const std::filesystem::path& a, const std::filesystem::path& b) : a_(a), b_(b) {
  compare_settings();
}

void RecordingPair::compare_settings() {
  const auto &a = a_.file.header(), &b = b_.file.header();
  const auto note = [&](const std::string& what, const std::string& one, const std::string& other) {
    if (one != other) settings_.push_back(what + ": " + one + ", " + other);
  };
  note("scene", a.scene, b.scene);
  note("engine", engine_of(a), engine_of(b));
  note("seed", std::to_string(a.seed), std::to_string(b.seed));
  note("parameters", a.parameters, b.parameters);
  note("version", a.build.version + " " + a.build.commit, b.build.version + " " + b.build.commit);
  note("compiler", a.build.compiler, b.build.compiler);
  compare_files();
  if (a.tick_ns != b.tick_ns)
    throw config::ConfigError({}, "their ticks have different lengths (" + std::to_string(a.tick_ns) +
                                      " and " + std::to_string(b.tick_ns) +
                                      " ns), so no tick of one is one of the other");
}

// Files of two folders may have one name. They stand in the order of their folders.
void RecordingPair::compare_files() {
  std::map<std::string, std::pair<std::vector<std::uint32_t>, std::vector<std::uint32_t>>> crcs;
  const auto name_of = [](const FileEntry& file) {
    return std::filesystem::path(file.name).filename().string();
  };
  for (const auto& file : a_.file.header().files) crcs[name_of(file)].first.push_back(file.crc);
  for (const auto& file : b_.file.header().files) crcs[name_of(file)].second.push_back(file.crc);
  const auto before = settings_.size();
  for (const auto& [name, of] : crcs) {
    const auto& [in_a, in_b] = of;
    for (std::size_t i = 0; i < std::max(in_a.size(), in_b.size()); ++i) {
      if (i >= in_b.size())
        settings_.push_back("file " + name + ": in A only");
      else if (i >= in_a.size())
        settings_.push_back("file " + name + ": in B only");
      else if (in_a[i] != in_b[i])
        settings_.push_back("file " + name + ": not the same content");
    }
  }
  same_files_ = settings_.size() == before;
}

// The descriptions of all parts come before the first tick; those of parts that come later are not compared.
void RecordingPair::pair_ports() {
  const auto full = [](const Name& name) { return name.part + "/" + name.port; };
  std::map<std::string, std::size_t> in_b;
  for (std::size_t i = 0; i < b_.names.size(); ++i) in_b.emplace(full(b_.names[i]), i);
  for (std::size_t i = 0; i < a_.names.size(); ++i) {
    const auto found = in_b.find(full(a_.names[i]));
    if (found == in_b.end()) {
      only_a_.push_back(full(a_.names[i]));
      continue;
    }
    ports_.push_back({.part = a_.names[i].part, .name = a_.names[i].port});
    places_.emplace_back(i, found->second);
    in_b.erase(found);
  }
  for (const auto& name : b_.names)
    if (in_b.contains(full(name))) only_b_.push_back(full(name));
}

bool RecordingPair::next() {
  const bool begins = ticks_a() == 0 && ticks_b() == 0;
  a_.is_there = a_.is_there && a_.next();
  b_.is_there = b_.is_there && b_.next();
  if (begins) pair_ports();
  compare_states();
  if (a_.is_there != b_.is_there) differ();
  if (!both()) return a_.is_there || b_.is_there;
  const auto &a = a_.now, &b = b_.now;
  const bool hashed = a.state_hash != kNoHash && b.state_hash != kNoHash;
  if (a.tick != b.tick || a.era != b.era || (hashed && a.state_hash != b.state_hash)) differ();
  compare_ports();
  return true;
}

double RecordingPair::seconds(std::uint64_t ticks) const {
  return static_cast<double>(ticks) * static_cast<double>(a_.file.header().tick_ns) / 1e9;
}

void RecordingPair::differ() {
  if (!first_) first_ = {std::max(ticks_a(), ticks_b()), (a_.is_there ? a_ : b_).now.tick};
}

// One may begin with a state, or have taken an input behind its last tick, where the other has not.
void RecordingPair::compare_states() {
  const auto &a = a_.whole, &b = b_.whole;
  if (!a || !b || a->at.position != b->at.position || a->inputs != b->inputs) return;
  if (!first_ && a->state != b->state) first_ = a->at;
  a_.whole.reset();
  b_.whole.reset();
}

void RecordingPair::compare_ports() {
  for (std::size_t i = 0; i < ports_.size(); ++i) {
    Port& port = ports_[i];
    port.a = a_.values[places_[i].first];
    port.b = b_.values[places_[i].second];
    if (same(port.a, port.b)) continue;
    differ();
    if (!port.first) {
      port.first = {ticks_a(), a_.now.tick};
      port.first_a = port.a;
      port.first_b = port.b;
    }
    double apart = std::abs(port.a - port.b);
    if (std::isnan(apart)) apart = std::numeric_limits<double>::infinity();
    if (apart <= port.max_abs) continue;
    port.max_abs = apart;
    port.max_tick = a_.now.tick;
  }
}

}  // namespace visum::recording
