// Plain values to bytes. Each message is built in an arena of the thread, which is emptied afterwards. Those
// of every tick take less: ticks are built in a message that stays, and samples are written without one.
#include <google/protobuf/arena.h>
#include <google/protobuf/io/coded_stream.h>

#include <array>
#include <bit>
#include <cstring>

#include "protocol/recording/loaded_scene.h"
#include "protocol/recording/records.h"
#include "protocol/wire.h"
#include "recording.pb.h"

namespace visum::recording {
namespace {

using google::protobuf::Arena;

template <typename Message>
void append(std::vector<std::byte>& to, const Message& message) {
  const auto start = to.size();
  to.resize(start + message.ByteSizeLong());
  message.SerializeWithCachedSizesToArray(reinterpret_cast<std::uint8_t*>(to.data() + start));
}

// Builds a message with `fill` and appends its bytes.
template <typename Message, typename Fill>
void append(std::vector<std::byte>& to, const Fill& fill) {
  struct Scratch {
    alignas(8) std::array<char, 16384> block;
    Arena arena{block.data(), block.size()};
  };
  thread_local Scratch scratch;
  auto& message = *Arena::CreateMessage<Message>(&scratch.arena);
  fill(message);
  append(to, message);
  scratch.arena.Reset();
}

// Fields of a message, as protobuf.dev/programming-guides/encoding has them; numbers below 16, so that a tag
// is one byte. Fields that are zero or empty are left out.
class FieldWriter {
 public:
  static constexpr std::size_t kMostOfNumber = 11;  // the tag, and 64 bits in sevens
  static constexpr std::size_t kMostOfHead = 6;     // the tag, and the length of what follows

  explicit FieldWriter(std::byte* at) : at_(reinterpret_cast<std::uint8_t*>(at)) {}

  void number(int field, std::uint64_t value) {
    if (value == 0) return;
    tag(field, 0);
    at_ = Coded::WriteVarint64ToArray(value, at_);
  }
  void bytes(int field, std::span<const std::byte> bytes) {
    if (bytes.empty()) return;
    tag(field, 2);
    at_ = Coded::WriteVarint32ToArray(static_cast<std::uint32_t>(bytes.size()), at_);
    std::memcpy(at_, bytes.data(), bytes.size());
    at_ += bytes.size();
  }
  const std::byte* end() const { return reinterpret_cast<const std::byte*>(at_); }

 private:
  using Coded = google::protobuf::io::CodedOutputStream;
  void tag(int field, std::uint32_t type) {
    at_ = Coded::WriteTagToArray(static_cast<std::uint32_t>(field) << 3 | type, at_);
  }
  std::uint8_t* at_;
};

template <typename Numbers, typename Field>
void put_numbers(const Numbers& from, Field& to) {
  to.Add(from.begin(), from.end());
}

void put(std::span<const std::byte> from, std::string& to) {
  to.assign(reinterpret_cast<const char*>(from.data()), from.size());
}

void put(const State& from, v1::State& to);

void put_files(const config::Files& from, google::protobuf::RepeatedPtrField<v1::ReadFile>& to) {
  for (const auto& [path, content] : from) {
    auto& entry = *to.Add();
    entry.set_path(path);
    entry.set_content(content);
  }
}

// For Header and LoadScene.
template <typename From, typename To>
void put_packages(const From& from, To& to) {
  for (const auto& [name, folder] : from.packages) {
    auto& entry = *to.add_packages();
    entry.set_name(name);
    entry.set_folder(folder);
  }
  for (const auto& folder : from.package_folders) to.add_package_folders(folder);
}

void put(const SpawnedModel& from, v1::SpawnModel& to) {
  to.set_file(from.file);
  to.set_name(from.name);
  put_numbers(from.pose, *to.mutable_pose());
  put_files(from.files, *to.mutable_files());
}

void put(const LoadedScene& from, v1::LoadScene& to) {
  to.set_scene(from.name);
  to.set_scene_file(from.file);
  to.set_engine(from.engine);
  to.set_parameters(from.parameters);
  to.set_seed(from.seed);
  put_packages(from, to);
  put_files(from.files, *to.mutable_files());
}

struct PutInput {
  v1::Input& to;

  void operator()(const WriteInputs& m) const {
    auto& w = *to.mutable_write_inputs();
    w.mutable_part()->assign(m.part);
    w.set_first_port(m.first_port);
    put_numbers(m.values, *w.mutable_values());
  }
  void operator()(const LoseController& m) const {
    to.mutable_lose_controller()->mutable_part()->assign(m.part);
  }
  void operator()(const SetParameter& m) const {
    auto& w = *to.mutable_set_parameter();
    w.mutable_part()->assign(m.part);
    w.mutable_name()->assign(m.name);
    protocol::wire::put(m.value, *w.mutable_value());
  }
  void operator()(const WriteBlackboard& m) const {
    auto& w = *to.mutable_write_blackboard();
    w.mutable_part()->assign(m.part);
    w.mutable_name()->assign(m.name);
    w.set_offset(m.offset);
    put(m.data, *w.mutable_data());
  }
  void operator()(const BusTelegram& m) const {
    auto& w = *to.mutable_bus_telegram();
    w.mutable_part()->assign(m.part);
    w.set_wire(m.wire);
    w.set_kind(m.kind);
    w.set_module(m.module);
    put(m.data, *w.mutable_data());
  }
  void operator()(const PushBody& m) const {
    auto& w = *to.mutable_push_body();
    w.set_body(m.body);
    put_numbers(m.force_n, *w.mutable_force_n());
    put_numbers(m.torque_nm, *w.mutable_torque_nm());
    w.set_until_tick(m.until_tick);
  }
  void operator()(const SetBody& m) const {
    auto& w = *to.mutable_set_body();
    w.set_body(m.body);
    if (m.moves) put_numbers(m.pose, *w.mutable_pose());
    put_numbers(m.velocity, *w.mutable_velocity());
    put_numbers(m.turn_rate, *w.mutable_velocity());
  }
  void operator()(const SetJoints& m) const {
    auto& w = *to.mutable_set_joints();
    w.mutable_joints()->Add(m.joints.begin(), m.joints.end());
    put_numbers(m.positions, *w.mutable_positions());
    put_numbers(m.velocities, *w.mutable_velocities());
  }
  void operator()(const PullBody& m) const {
    auto& w = *to.mutable_pull_body();
    w.set_body(m.body);
    put_numbers(m.point, *w.mutable_point());
    put_numbers(m.target, *w.mutable_target());
    w.set_max_force_n(m.max_force_n);
    w.set_until_tick(m.until_tick);
  }
  void operator()(const RestoreState& m) const { put(*m.state, *to.mutable_restore_state()); }
  void operator()(const ReleaseBody& m) const { to.mutable_release_body()->set_body(m.body); }
  void operator()(const Reset& m) const {
    to.mutable_reset()->set_scope(static_cast<std::uint32_t>(m.scope));
  }
  void operator()(const TakeSnapshot& m) const { to.mutable_take_snapshot()->set_number(m.number); }
  void operator()(const RestoreSnapshot& m) const { to.mutable_restore_snapshot()->set_number(m.number); }
  void operator()(const AddBody& m) const { to.mutable_add_body()->mutable_yaml()->assign(m.yaml); }
  void operator()(const RemoveBody& m) const { to.mutable_remove_body()->mutable_name()->assign(m.name); }
  void operator()(const SpawnModel& m) const { put(*m.model, *to.mutable_spawn_model()); }
  void operator()(const RemoveModel& m) const { to.mutable_remove_model()->mutable_name()->assign(m.name); }
  void operator()(const LoadScene& m) const { put(*m.scene, *to.mutable_load_scene()); }
  void operator()(const InjectFault& m) const {
    auto& w = *to.mutable_inject_fault();
    w.mutable_part()->assign(m.part);
    w.mutable_kind()->assign(m.kind);
    put_numbers(m.numbers, *w.mutable_numbers());
    w.set_until_tick(m.until_tick);
  }
  void operator()(const ClearFault& m) const {
    auto& w = *to.mutable_clear_fault();
    w.mutable_part()->assign(m.part);
    w.mutable_kind()->assign(m.kind);
    w.set_drive(m.drive);
  }
};

void put(const State& from, v1::State& to) {
  to.set_tick(from.tick);
  to.set_era(from.era);
  to.set_revision(from.revision);
  to.set_next_snapshot(from.next_snapshot);
  put(from.state, *to.mutable_state());
  for (const auto& kept : from.snapshots) {
    auto& entry = *to.add_snapshots();
    entry.set_number(kept.number);
    put(kept.state, *entry.mutable_state());
  }
  for (const auto& edit : from.edits) {
    const PutInput entry{*to.add_edits()};
    switch (edit.kind) {
      case State::Edit::Kind::kBodyCame:
        entry(AddBody{edit.text});
        break;
      case State::Edit::Kind::kBodyWent:
        entry(RemoveBody{edit.text});
        break;
      case State::Edit::Kind::kModelCame:
        entry(SpawnModel{edit.model});
        break;
      case State::Edit::Kind::kModelWent:
        entry(RemoveModel{edit.text});
        break;
    }
  }
}

void put(const Build& from, v1::Build& to) {
  to.set_version(from.version);
  to.set_commit(from.commit);
  to.set_compiler(from.compiler);
  to.set_instruction_set(from.instruction_set);
  for (const auto& engine : from.engines) to.add_engines(engine);
}

}  // namespace

void encode(const Header& from, std::vector<std::byte>& to) {
  append<v1::Header>(to, [&](v1::Header& w) {
    w.set_format(from.format);
    w.set_scene_file(from.scene_file);
    w.set_scene(from.scene);
    w.set_engine(from.engine);
    w.set_clock(from.clock);
    w.set_seed(from.seed);
    w.set_tick_ns(from.tick_ns);
    w.set_parameters(from.parameters);
    put_packages(from, w);
    put(from.build, *w.mutable_build());
    for (const auto& file : from.files) {
      auto& entry = *w.add_files();
      entry.set_name(file.name);
      entry.set_size(file.size);
      entry.set_crc(file.crc);
    }
  });
}

void encode(const TimedInput& from, std::vector<std::byte>& to) {
  append<v1::Input>(to, [&](v1::Input& w) {
    w.set_tick(from.tick);
    w.set_era(from.era);
    std::visit(PutInput{w}, from.input);
  });
}

void encode(const Tick& from, std::vector<std::byte>& to) {
  thread_local v1::Tick w;
  w.set_tick(from.tick);
  w.set_era(from.era);
  w.set_sim_time_ns(from.sim_time_ns);
  w.set_state_hash(from.state_hash);
  w.mutable_fault()->assign(from.fault);
  append(to, w);
}

// Samples are most of a recording. None was skipped, so `conflated` is zero.
void encode(const Sample& from, std::vector<std::byte>& to) {
  using Message = visum::v1::PartSample;
  static_assert(std::endian::native == std::endian::little, "numbers are copied as they stand in memory");
  static_assert(Message::kSensorOutputsFieldNumber < 16);
  const auto start = to.size();
  to.resize(start + from.part.size() + from.controller_inputs.size_bytes() +
            from.sensor_outputs.size_bytes() + 3 * FieldWriter::kMostOfHead + 3 * FieldWriter::kMostOfNumber);
  FieldWriter w(to.data() + start);
  w.bytes(Message::kPartFieldNumber, std::as_bytes(std::span(from.part)));
  w.number(Message::kTickFieldNumber, static_cast<std::uint64_t>(from.tick));
  w.number(Message::kSimTimeNsFieldNumber, static_cast<std::uint64_t>(from.sim_time_ns));
  w.number(Message::kEraFieldNumber, from.era);
  w.bytes(Message::kControllerInputsFieldNumber, std::as_bytes(from.controller_inputs));
  w.bytes(Message::kSensorOutputsFieldNumber, std::as_bytes(from.sensor_outputs));
  to.resize(static_cast<std::size_t>(w.end() - to.data()));
}

void encode(const State& from, std::vector<std::byte>& to) {
  append<v1::State>(to, [&](v1::State& w) { put(from, w); });
}

void encode(const LogLine& from, std::vector<std::byte>& to) {
  append<v1::LogLine>(to, [&](v1::LogLine& w) {
    w.mutable_level()->assign(from.level);
    w.mutable_text()->assign(from.text);
  });
}

void encode(const protocol::PartDescription& from, std::vector<std::byte>& to) {
  append<visum::v1::PartDescription>(to, [&](visum::v1::PartDescription& w) {
    protocol::wire::put({from, {}}, w);
  });
}

}  // namespace visum::recording
