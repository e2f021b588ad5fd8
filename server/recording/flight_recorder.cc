#include "server/recording/flight_recorder.h"

#include <fcntl.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <cerrno>
#include <fstream>
#include <new>
#include <stdexcept>
#include <system_error>
#include <utility>

namespace visum::recording {

FlightRecorder::FlightRecorder(cycle::Simulation& simulation, Origin origin, std::filesystem::path folder)
    : simulation_(simulation), origin_(std::move(origin)), folder_(std::move(folder)) {
  parts_changed();
  for (Half* half : {&now_, &before_}) {
    half->ticks.reserve(kTicks);
    half->ports.reserve(kTicks * ports_per_tick_);
  }
  revision_ = simulation_.revision();
  begin_half();
  simulation_.set_observer(this);
}

FlightRecorder::~FlightRecorder() {
  simulation_.set_observer(nullptr);
}

void FlightRecorder::begin_half() {
  std::swap(now_, before_);
  now_.ticks.clear();
  now_.ports.clear();
  now_.inputs.clear();
  now_.input_bytes.clear();
  now_.in_use = true;
  simulation_.keep(now_.begin);
}

bool FlightRecorder::parts_changed() {
  std::vector<const hwparts::Part*> parts;
  ports_per_tick_ = 0;
  for (const auto& bound : std::as_const(simulation_).parts()) {
    parts.push_back(bound.part.get());
    ports_per_tick_ += bound.controller_inputs.size() + bound.sensor_outputs.size();
  }
  if (parts == parts_) return false;
  parts_ = std::move(parts);
  return true;
}

void FlightRecorder::forget() {
  now_.in_use = before_.in_use = false;
}

// A file holds the ticks of one scene.
void FlightRecorder::begin_scene(const LoadedScene& scene) {
  dump_.clear();
  forget();
  origin_ = origin_of(scene);
  parts_changed();
  revision_ = simulation_.revision();
  begin_half();
}

void FlightRecorder::took(const TimedInput& input) try {
  if (const auto* loaded = std::get_if<LoadScene>(&input.input)) return begin_scene(*loaded->scene);
  if (simulation_.frozen()) return;
  if (!now_.in_use) {  // a frozen world runs again: this input revived it
    dump_.clear();
    return begin_half();
  }
  if (std::exchange(revision_, simulation_.revision()) != simulation_.revision() && parts_changed()) {
    forget();  // the ticks so far have the ports of other parts
    return begin_half();
  }
  const auto from = now_.input_bytes.size();
  encode(input, now_.input_bytes);
  const auto size = now_.input_bytes.size() - from;
  now_.inputs.push_back({now_.ticks.size(), input.tick, from, size});
  if (now_.input_bytes.size() <= kInputBytes) return;
  if (size > kInputBytes) forget();  // this input alone is too large to be kept
  begin_half();
} catch (const std::bad_alloc&) {
  forget();  // the next input begins anew
}

void FlightRecorder::ticked() try {
  if (!now_.in_use) return;
  const bool hashed = simulation_.frozen() || is_hashed(now_.ticks.size());
  now_.ticks.push_back({simulation_.tick_count(),
                        simulation_.era(),
                        simulation_.sim_time_ns(),
                        hashed ? simulation_.state_hash() : kNoHash,
                        {}});
  for (const auto& bound : std::as_const(simulation_).parts()) {
    now_.ports.insert(now_.ports.end(), bound.controller_inputs.begin(), bound.controller_inputs.end());
    now_.ports.insert(now_.ports.end(), bound.sensor_outputs.begin(), bound.sensor_outputs.end());
  }
  if (simulation_.frozen()) return dump_now();
  if (now_.ticks.size() == kTicks) begin_half();
} catch (const std::bad_alloc&) {
  forget();
}

void FlightRecorder::dump_now() {
  const auto ticks = now_.ticks.size() + (before_.in_use ? before_.ticks.size() : 0);
  if (++files_ > kMostFiles) {
    spdlog::warn("the world froze for the {}th time: the ticks before it are not written any more", files_);
    return forget();
  }
  std::filesystem::path file;
  try {
    file = make_file();
    write(file);
    dump_ = file.string();
    spdlog::error("the world froze: its last {} ticks are in {}", ticks, dump_);
  } catch (const std::exception& error) {
    spdlog::error("the world froze, and its last ticks cannot be written: {}", error.what());
    std::error_code none;
    if (!file.empty()) std::filesystem::remove(file, none);
  }
  forget();
}

// O_EXCL finds a free name. The process number alone is not enough: in a container every run has the same
// one.
std::filesystem::path FlightRecorder::make_file() const {
  const auto folder = std::filesystem::absolute(folder_).lexically_normal();
  std::filesystem::create_directories(folder);
  for (int number = files_;; ++number) {
    const auto name = "frozen-" + std::to_string(::getpid()) + "-" + std::to_string(number) + "-tick-" +
                      std::to_string(simulation_.tick_count()) + ".mcap";
    auto file = folder / name;
    if (const int fd = ::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644); fd >= 0) {
      ::close(fd);
      return file;
    }
    if (errno != EEXIST) throw std::system_error(errno, std::generic_category(), file.string());
  }
}

void FlightRecorder::write(const std::filesystem::path& file) const {
  std::ofstream out(file, std::ios::binary | std::ios::trunc);
  out.exceptions(std::ios::failbit | std::ios::badbit);
  McapWriter writer(
      [&](Bytes bytes) {
        out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
      },
      "visumd");
  const auto channels = write_beginning(writer, simulation_, origin_);
  std::uint64_t time_ns = 0;
  if (before_.in_use) write_half(before_, writer, channels, time_ns);
  write_half(now_, writer, channels, time_ns);
  writer.close();
  out.flush();
}

void FlightRecorder::write_half(const Half& half, McapWriter& writer, const Channels& channels,
                                std::uint64_t& time_ns) const {
  std::vector<std::byte> bytes;
  const auto put = [&](std::uint16_t channel, std::int64_t sim_time_ns, const auto& message) {
    bytes.clear();
    encode(message, bytes);
    writer.write(channel, time_ns, static_cast<std::uint64_t>(sim_time_ns), bytes);
  };
  const auto tick_ns = simulation_.model().tick_ns;
  put(channels.states, half.begin.tick * tick_ns, half.begin);
  auto input = half.inputs.begin();
  std::span<const double> ports = half.ports;
  const auto next_ports = [&](std::size_t count) {
    const auto taken = ports.first(count);
    ports = ports.subspan(count);
    return taken;
  };
  const auto put_inputs = [&](std::size_t ticks) {
    for (; input != half.inputs.end() && input->ticks == ticks; ++input)
      writer.write(channels.inputs, time_ns, static_cast<std::uint64_t>(input->tick * tick_ns),
                   Bytes(half.input_bytes).subspan(input->from, input->size));
  };
  for (std::size_t i = 0; i < half.ticks.size(); ++i) {
    put_inputs(i);
    time_ns += static_cast<std::uint64_t>(tick_ns);
    auto tick = half.ticks[i];
    const auto parts = std::as_const(simulation_).parts();
    for (std::size_t part = 0; part < parts.size(); ++part) {
      const auto inputs = next_ports(parts[part].controller_inputs.size());
      const auto outputs = next_ports(parts[part].sensor_outputs.size());
      put(channels.parts[part], tick.sim_time_ns,
          Sample{parts[part].part->description().name, tick.tick, tick.sim_time_ns, tick.era, inputs,
                 outputs});
    }
    if (&half == &now_ && i + 1 == half.ticks.size()) tick.fault = simulation_.fault();
    put(channels.ticks, tick.sim_time_ns, tick);
  }
  put_inputs(half.ticks.size());
}

}  // namespace visum::recording
