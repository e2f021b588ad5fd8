#include "server/recording/recorder.h"

#include <algorithm>
#include <new>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "server/recording/recording_writer.h"

namespace visum::recording {
namespace {

constexpr std::uint64_t kStatePeriod_ns = 1'000'000'000;  // of simulated time

RecordingWriter::Overflow overflow_of(scene::ClockKind clock) {
  return clock == scene::ClockKind::kRealtime ? RecordingWriter::Overflow::kEnd
                                              : RecordingWriter::Overflow::kWait;
}

}  // namespace

Recorder::Recorder(cycle::Simulation& simulation, const Origin& origin, const std::filesystem::path& file)
    : Recorder(simulation, origin, file, Start::kNow) {}

std::unique_ptr<Recorder> Recorder::prepare(cycle::Simulation& simulation, const Origin& origin,
                                            const std::filesystem::path& file) {
  return std::unique_ptr<Recorder>(new Recorder(simulation, origin, file, Start::kLater));
}

Recorder::Recorder(cycle::Simulation& simulation, const Origin& origin, const std::filesystem::path& file,
                   Start start) try
    : simulation_(simulation),
      is_second_(start == Start::kLater),
      writer_(std::make_unique<RecordingWriter>(file, overflow_of(simulation.scene().clock))) {
  channels_ = write_beginning(writer_->writer(), simulation_, origin);
  for (const auto& bound : std::as_const(simulation).parts()) known_.push_back(bound.part);
  if (is_second_) return;
  if (origin.has_past) {
    take_state();
    writer_->put_first(channels_.states, static_cast<std::uint64_t>(simulation_.sim_time_ns()), bytes_);
  }
  writer_->start();
  simulation_.set_observer(this);
} catch (const std::system_error&) {
  throw;  // no thread can be started, which has nothing to do with the file
} catch (const std::exception& error) {
  throw std::runtime_error("the recording '" + file.string() + "' cannot be written: " + error.what());
}

// The world has a past, whatever its origin says.
void Recorder::begin() {
  simulation_.keep(first_);
  simulation_.set_second_observer(this);
}

void Recorder::write_first() {
  std::vector<std::byte> bytes;
  encode(first_, bytes);
  const auto time_ns = first_.tick * simulation_.model().tick_ns;
  writer_->put_first(channels_.states, static_cast<std::uint64_t>(time_ns), bytes);
  first_ = {};
  writer_->start();
}

Recorder::~Recorder() {
  close();
}

void Recorder::stop_observing() {
  is_second_ ? simulation_.set_second_observer(nullptr) : simulation_.set_observer(nullptr);
}

void Recorder::end() try {
  stop_observing();
  if (!hash_is_written_ && writer_->started() && !writer_->ended() && !simulation_.frozen()) put_state();
} catch (const std::bad_alloc&) {
  writer_->end(kNoMemory);
}

bool Recorder::close() {
  if (!is_second_) stop_observing();
  return writer_->close();
}

void Recorder::put(std::uint16_t channel, std::int64_t publish_time_ns) {
  writer_->put(channel, time_ns_, static_cast<std::uint64_t>(publish_time_ns), bytes_);
}

void Recorder::took(const TimedInput& input) try {
  if (writer_->ended()) return;
  bytes_.clear();
  encode(input, bytes_);
  put(channels_.inputs, input.tick * simulation_.model().tick_ns);
  hash_is_written_ = false;
  look_at_parts();
} catch (const std::bad_alloc&) {
  writer_->end(kNoMemory);
}

void Recorder::ticked() try {
  if (writer_->ended()) return;
  time_ns_ += static_cast<std::uint64_t>(simulation_.model().tick_ns);
  const auto tick = simulation_.tick_count();
  const auto time_ns = simulation_.sim_time_ns();
  const auto parts = std::as_const(simulation_).parts();
  look_at_parts();
  for (std::size_t i = 0; i < parts.size(); ++i) {
    bytes_.clear();
    encode(Sample{parts[i].part->description().name, tick, time_ns, simulation_.era(),
                  parts[i].controller_inputs, parts[i].sensor_outputs},
           bytes_);
    put(channel_of_[i], time_ns);
  }
  const bool state_due = time_ns_ >= next_state_ns_ && !simulation_.frozen();
  hash_is_written_ = is_hashed(ticks_++) || state_due || simulation_.frozen();
  const auto hash = hash_is_written_ ? simulation_.state_hash() : kNoHash;
  bytes_.clear();
  encode(Tick{tick, simulation_.era(), time_ns, hash, simulation_.fault()}, bytes_);
  put(channels_.ticks, time_ns);
  if (state_due) put_state();
} catch (const std::bad_alloc&) {
  writer_->end(kNoMemory);
}

void Recorder::look_at_parts() {
  if (revision_ == simulation_.revision()) return;
  revision_ = simulation_.revision();
  std::vector<const hwparts::Part*> now;
  channel_of_.clear();
  for (const auto& bound : std::as_const(simulation_).parts()) {
    now.push_back(bound.part.get());
    const auto known = std::ranges::find(known_, bound.part);
    const bool is_new = known == known_.end();
    channel_of_.push_back(is_new ? channels_.spawned
                                 : channels_.parts[static_cast<std::size_t>(known - known_.begin())]);
    if (!is_new || std::ranges::find(seen_, now.back()) != seen_.end()) continue;
    bytes_.clear();
    encode(bound.part->description(), bytes_);
    put(channels_.spawned_described, simulation_.sim_time_ns());
  }
  seen_ = std::move(now);
}

void Recorder::take_state() {
  simulation_.keep(state_);
  bytes_.clear();
  encode(state_, bytes_);
}

// The state serves seeking only. Where the queue has no room for it, it is left out, so that the recording
// goes on.
void Recorder::put_state() {
  next_state_ns_ = time_ns_ + kStatePeriod_ns;
  take_state();
  if (writer_->has_room_for(bytes_.size())) put(channels_.states, simulation_.sim_time_ns());
}

void Recorder::log(std::string_view level, std::string_view text) {
  std::vector<std::byte> line;
  encode(LogLine{level, text}, line);
  writer_->put_line(channels_.log, std::move(line));
}

}  // namespace visum::recording
