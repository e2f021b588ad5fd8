#include "server/recording/recorder.h"

#include <utility>

#include "server/recording/build.h"
#include "server/recording/scribe.h"

namespace visum::recording {
namespace {

constexpr std::string_view kEncoding = "protobuf";

std::string key_of(const std::filesystem::path& file) {
  return std::filesystem::absolute(file).lexically_normal().string();
}

Header header_of(const scene::Scene& scene, const Origin& origin) {
  Header header;
  header.scene_file = key_of(scene.file);
  header.scene = scene.name;
  header.engine = origin.engine;
  header.parameters = origin.parameters;
  header.clock = scene::name_of(scene.clock);
  header.seed = scene.seed;
  header.tick_ns = scene.world.tick_ns;
  header.build = this_build(scene);
  for (const auto& [name, content] : origin.files)
    header.files.push_back({name, content.size(), crc32(bytes_of(content))});
  return header;
}

Scribe::Overflow overflow_of(scene::ClockKind clock) {
  return clock == scene::ClockKind::kRealtime ? Scribe::Overflow::kEnd : Scribe::Overflow::kWait;
}

}  // namespace

Recorder::Recorder(cycle::Simulation& simulation, const Origin& origin, const std::filesystem::path& file)
    : simulation_(simulation),
      scribe_(std::make_unique<Scribe>(file, overflow_of(simulation.scene().clock))) {
  try {
    write_beginning(origin);
  } catch (const std::runtime_error& error) {
    throw std::runtime_error("the recording '" + file.string() + "' cannot be written: " + error.what());
  }
  scribe_->start();
  simulation_.set_witness(this);
}

Recorder::~Recorder() {
  simulation_.set_witness(nullptr);
}

void Recorder::write_beginning(const Origin& origin) {
  auto& writer = scribe_->writer();
  for (const auto& [name, content] : origin.files)
    writer.attach({name, "application/octet-stream", bytes_of(content)});
  const auto channel = [&](std::string_view topic, std::string_view schema_name) {
    const auto schema_id = writer.add_schema(schema_name, kEncoding, schema());
    return writer.add_channel(topic, schema_id, kEncoding);
  };
  const auto header = channel(kHeaderTopic, kHeaderSchema);
  bytes_.clear();
  encode(header_of(simulation_.scene(), origin), bytes_);
  writer.write(header, 0, 0, bytes_);
  inputs_ = channel(kInputTopic, kInputSchema);
  ticks_ = channel(kTickTopic, kTickSchema);
  log_ = channel(kLogTopic, kLogSchema);
  const auto samples = writer.add_schema(kSampleSchema, kEncoding, schema());
  const auto descriptions = writer.add_schema(kDescriptionSchema, kEncoding, schema());
  for (const auto& bound : simulation_.parts()) {
    const auto& description = bound.part->description();
    const auto topic = std::string(kPartTopic) + description.name;
    parts_.push_back(writer.add_channel(topic, samples, kEncoding));
    const auto described =
        writer.add_channel(topic + std::string(kDescriptionTopic), descriptions, kEncoding);
    bytes_.clear();
    encode(description, bytes_);
    writer.write(described, 0, 0, bytes_);
  }
  writer.flush();
}

void Recorder::put(std::uint16_t channel) {
  scribe_->put(channel, time_ns_, static_cast<std::uint64_t>(simulation_.sim_time_ns()), bytes_);
}

void Recorder::took(const TimedInput& input) {
  if (scribe_->ended()) return;
  bytes_.clear();
  encode(input, bytes_);
  put(inputs_);
}

void Recorder::ticked() {
  if (scribe_->ended()) return;
  time_ns_ += static_cast<std::uint64_t>(simulation_.model().tick_ns);
  const auto tick = simulation_.tick_count();
  const auto time_ns = simulation_.sim_time_ns();
  const auto parts = std::as_const(simulation_).parts();
  for (std::size_t i = 0; i < parts.size(); ++i) {
    bytes_.clear();
    encode(Sample{parts[i].part->description().name, tick, time_ns, simulation_.era(),
                  parts[i].controller_inputs, parts[i].sensor_outputs},
           bytes_);
    put(parts_[i]);
  }
  bytes_.clear();
  encode(Tick{tick, simulation_.era(), time_ns, simulation_.state_hash(), simulation_.fault()}, bytes_);
  put(ticks_);
}

void Recorder::log(std::string_view level, std::string_view text) {
  std::vector<std::byte> line;
  encode(LogLine{level, text}, line);
  scribe_->put_line(log_, std::move(line));
}

}  // namespace visum::recording
