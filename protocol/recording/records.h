// The messages of a recording as plain values, and their translation to and from recording.proto. Pure
// functions, any thread. encode() appends to a vector that keeps its capacity, and allocates nothing else
// once warm. decode() returns false for bytes that are no such message.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "protocol/messages.h"
#include "protocol/recording/input.h"
#include "protocol/recording/little_endian.h"
#include "protocol/recording/state.h"

namespace visum::recording {

// The topics. A part's samples have the topic kPartTopic + NAME; its description has that +
// kDescriptionTopic.
inline constexpr std::string_view kHeaderTopic = "/recording";
inline constexpr std::string_view kInputTopic = "/inputs";
inline constexpr std::string_view kTickTopic = "/ticks";
inline constexpr std::string_view kStateTopic = "/states";
inline constexpr std::string_view kLogTopic = "/log";
inline constexpr std::string_view kPartTopic = "/parts/";
inline constexpr std::string_view kDescriptionTopic = "/description";
// The topics of all parts together that came with a model after the recording began.
inline constexpr std::string_view kSpawnedTopic = "/spawned";
inline constexpr std::string_view kSpawnedDescriptionTopic = "/spawned/description";

inline constexpr std::uint32_t kFormat = 1;

struct Build {
  std::string version, commit, compiler, instruction_set;
  std::vector<std::string> engines;
  bool operator==(const Build&) const = default;
};
struct FileEntry {
  std::string name;
  std::uint64_t size = 0;
  std::uint32_t crc = 0;
};
struct Header {
  std::uint32_t format = kFormat;
  std::string scene_file, scene, engine, clock;
  std::uint64_t seed = 0;
  std::int64_t tick_ns = 0;
  Build build;
  std::vector<FileEntry> files;
  std::string parameters;  // of the scene's file, as a YAML map; empty: its defaults
  std::vector<std::pair<std::string, std::string>> packages;  // name and folder, as --package gave them
  std::vector<std::string> package_folders;                   // of the environment
};
// The hash takes a fifteenth of the arm's tick. So it is taken in the first tick of a recording and in every
// 50th after it, where a simulated second is complete, and where the world froze. `count`: of the ticks
// before.
inline constexpr std::uint64_t kHashEvery = 50;
inline bool is_hashed(std::uint64_t count) {
  return count % kHashEvery == 0;
}
inline constexpr std::uint64_t kNoHash = 0;  // it was not taken in this tick
struct Tick {
  std::int64_t tick = 0;
  std::uint64_t era = 0;
  std::int64_t sim_time_ns = 0;
  std::uint64_t state_hash = 0;
  std::string_view fault;
};
// The ports of a part after a tick.
struct Sample {
  std::string_view part;
  std::int64_t tick = 0, sim_time_ns = 0;
  std::uint64_t era = 0;
  std::span<const double> controller_inputs, sensor_outputs;
};
struct LogLine {
  std::string_view level, text;
};

void encode(const Header& from, std::vector<std::byte>& to);
void encode(const TimedInput& from, std::vector<std::byte>& to);
void encode(const Tick& from, std::vector<std::byte>& to);
void encode(const Sample& from, std::vector<std::byte>& to);
void encode(const State& from, std::vector<std::byte>& to);
void encode(const LogLine& from, std::vector<std::byte>& to);
void encode(const protocol::PartDescription& from, std::vector<std::byte>& to);

bool decode(Bytes from, Header& to);
bool decode(Bytes from, State& to);
bool decode(Bytes from, protocol::PartSample& to);
bool decode(Bytes from, protocol::PartDescription& to);
// A decoded message whose fields are views. It owns the memory that they refer to.
class TickMessage {
 public:
  bool decode(Bytes from);
  Tick tick;

 private:
  std::string fault_;
};
class LogMessage {
 public:
  bool decode(Bytes from);
  LogLine line;

 private:
  std::string level_, text_;
};
class InputMessage {
 public:
  InputMessage();
  ~InputMessage();
  bool decode(Bytes from);
  TimedInput input;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// The schema with this name: the description of the message and of those that it refers to, as Protobuf's
// FileDescriptorSet. Throws std::invalid_argument where there is none.
Bytes schema(std::string_view name);
// The names of the schemas.
inline constexpr std::string_view kHeaderSchema = "visum.recording.v1.Header";
inline constexpr std::string_view kInputSchema = "visum.recording.v1.Input";
inline constexpr std::string_view kTickSchema = "visum.recording.v1.Tick";
inline constexpr std::string_view kStateSchema = "visum.recording.v1.State";
inline constexpr std::string_view kLogSchema = "visum.recording.v1.LogLine";
inline constexpr std::string_view kSampleSchema = "visum.v1.PartSample";
inline constexpr std::string_view kDescriptionSchema = "visum.v1.PartDescription";

}  // namespace visum::recording
