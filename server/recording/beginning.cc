#include "server/recording/beginning.h"

#include <filesystem>

#include "protocol/recording/records.h"
#include "server/recording/build.h"

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
  for (const auto& [name, folder] : origin.packages.given) header.packages.emplace_back(name, key_of(folder));
  for (const auto& folder : origin.packages.folders) header.package_folders.push_back(key_of(folder));
  for (const auto& [name, content] : origin.files)
    header.files.push_back({name, content.size(), crc32(bytes_of(content))});
  return header;
}

}  // namespace

Origin origin_of(const LoadedScene& scene) {
  Origin origin{scene.files, scene.engine, scene.parameters, true, {}};
  for (const auto& [name, folder] : scene.packages) origin.packages.given[name] = folder;
  origin.packages.folders.assign(scene.package_folders.begin(), scene.package_folders.end());
  return origin;
}

Channels write_beginning(McapWriter& writer, const cycle::Simulation& simulation, const Origin& origin) {
  Channels channels;
  std::vector<std::byte> bytes;
  for (const auto& [name, content] : origin.files)
    writer.attach({name, "application/octet-stream", bytes_of(content)});
  const auto channel = [&](std::string_view topic, std::string_view schema_name) {
    const auto schema_id = writer.add_schema(schema_name, kEncoding, schema(schema_name));
    return writer.add_channel(topic, schema_id, kEncoding);
  };
  const auto header = channel(kHeaderTopic, kHeaderSchema);
  bytes.clear();
  encode(header_of(simulation.scene(), origin), bytes);
  writer.write(header, 0, 0, bytes);
  channels.inputs = channel(kInputTopic, kInputSchema);
  channels.ticks = channel(kTickTopic, kTickSchema);
  channels.states = channel(kStateTopic, kStateSchema);
  channels.log = channel(kLogTopic, kLogSchema);
  const auto samples = writer.add_schema(kSampleSchema, kEncoding, schema(kSampleSchema));
  const auto descriptions = writer.add_schema(kDescriptionSchema, kEncoding, schema(kDescriptionSchema));
  for (const auto& bound : simulation.parts()) {
    const auto& description = bound.part->description();
    const auto topic = std::string(kPartTopic) + description.name;
    channels.parts.push_back(writer.add_channel(topic, samples, kEncoding));
    const auto described =
        writer.add_channel(topic + std::string(kDescriptionTopic), descriptions, kEncoding);
    bytes.clear();
    encode(description, bytes);
    writer.write(described, 0, 0, bytes);
  }
  channels.spawned = writer.add_channel(kSpawnedTopic, samples, kEncoding);
  channels.spawned_described = writer.add_channel(kSpawnedDescriptionTopic, descriptions, kEncoding);
  writer.flush();
  return channels;
}

}  // namespace visum::recording
