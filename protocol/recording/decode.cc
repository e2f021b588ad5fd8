// Bytes to plain values. Nothing in a file is trusted: lengths and kinds are checked here, names and numbers
// by the world that takes the inputs.
#include "protocol/codec.h"
#include "protocol/recording/loaded_scene.h"
#include "protocol/recording/records.h"
#include "protocol/wire.h"
#include "recording.pb.h"

namespace visum::recording {
namespace {

template <typename Message>
bool parse(Bytes from, Message& to) {
  return to.ParseFromArray(from.data(), static_cast<int>(from.size()));
}

std::span<const double> view_of(const google::protobuf::RepeatedField<double>& from) {
  return {from.data(), static_cast<std::size_t>(from.size())};
}

template <std::size_t size>
bool take_vector(const google::protobuf::RepeatedField<double>& from, std::array<double, size>& to) {
  if (from.size() != static_cast<int>(size)) return false;
  std::copy(from.begin(), from.end(), to.begin());
  return true;
}

bool take(const v1::BusTelegram& from, BusTelegram& to) {
  if (from.wire() > 1 || from.kind() > 2 || from.module() > 255 || from.data().size() > 8) return false;
  to = {from.part(), static_cast<std::uint8_t>(from.wire()), static_cast<std::uint8_t>(from.kind()),
        static_cast<std::uint8_t>(from.module()), bytes_of(from.data())};
  return true;
}

bool take(const v1::PushBody& from, PushBody& to) {
  to.body = from.body();
  to.until_tick = from.until_tick();
  return take_vector(from.force_n(), to.force_n) && take_vector(from.torque_nm(), to.torque_nm);
}

bool take(const v1::SetBody& from, SetBody& to) {
  to.body = from.body();
  to.moves = !from.pose().empty();
  if (to.moves && !take_vector(from.pose(), to.pose)) return false;
  if (from.velocity().size() != 6) return false;
  std::copy_n(from.velocity().begin(), 3, to.velocity.begin());
  std::copy_n(from.velocity().begin() + 3, 3, to.turn_rate.begin());
  return true;
}

bool take(const v1::SetJoints& from, SetJoints& to) {
  to = {{from.joints().data(), static_cast<std::size_t>(from.joints().size())},
        view_of(from.positions()),
        view_of(from.velocities())};
  return to.positions.size() == to.joints.size() && to.velocities.size() == to.joints.size();
}

bool take(const v1::PullBody& from, PullBody& to) {
  to.body = from.body();
  to.max_force_n = from.max_force_n();
  to.until_tick = from.until_tick();
  return take_vector(from.point(), to.point) && take_vector(from.target(), to.target);
}

config::Files files_of(const google::protobuf::RepeatedPtrField<v1::ReadFile>& from) {
  config::Files files;
  for (const auto& file : from) files[file.path()] = file.content();
  return files;
}

// For Header and LoadScene.
template <typename From, typename To>
void take_packages(const From& from, To& to) {
  for (const auto& package : from.packages()) to.packages.emplace_back(package.name(), package.folder());
  to.package_folders.assign(from.package_folders().begin(), from.package_folders().end());
}

// Null: its pose is not one.
std::shared_ptr<const SpawnedModel> model_of(const v1::SpawnModel& from) {
  auto model = std::make_shared<SpawnedModel>();
  model->file = from.file();
  model->name = from.name();
  if (!take_vector(from.pose(), model->pose)) return nullptr;
  model->files = files_of(from.files());
  return model;
}

// Null: its file is not among those that it was read from.
std::shared_ptr<const LoadedScene> scene_of(const v1::LoadScene& from) {
  auto scene = std::make_shared<LoadedScene>();
  scene->name = from.scene();
  scene->file = from.scene_file();
  scene->engine = from.engine();
  scene->parameters = from.parameters();
  scene->seed = from.seed();
  take_packages(from, *scene);
  scene->files = files_of(from.files());
  return scene->files.contains(scene->file) ? scene : nullptr;
}

bool take(const v1::SetParameter& from, SetParameter& to) {
  to.part = from.part();
  to.name = from.name();
  std::string why;
  return protocol::wire::take(from.value(), to.value, why);
}

bool take(const v1::Input& from, Input& to) {
  switch (from.what_case()) {
    case v1::Input::kWriteInputs: {
      const auto& w = from.write_inputs();
      to = WriteInputs{w.part(), w.first_port(), view_of(w.values())};
      return true;
    }
    case v1::Input::kLoseController:
      to = LoseController{from.lose_controller().part()};
      return true;
    case v1::Input::kSetParameter:
      return take(from.set_parameter(), to.emplace<SetParameter>());
    case v1::Input::kWriteBlackboard: {
      const auto& w = from.write_blackboard();
      to = WriteBlackboard{w.part(), w.name(), w.offset(), bytes_of(w.data())};
      return true;
    }
    case v1::Input::kBusTelegram:
      return take(from.bus_telegram(), to.emplace<BusTelegram>());
    case v1::Input::kPushBody:
      return take(from.push_body(), to.emplace<PushBody>());
    case v1::Input::kSetBody:
      return take(from.set_body(), to.emplace<SetBody>());
    case v1::Input::kSetJoints:
      return take(from.set_joints(), to.emplace<SetJoints>());
    case v1::Input::kPullBody:
      return take(from.pull_body(), to.emplace<PullBody>());
    case v1::Input::kReleaseBody:
      to = ReleaseBody{from.release_body().body()};
      return true;
    case v1::Input::kReset:
      if (from.reset().scope() > static_cast<std::uint32_t>(protocol::ResetScope::kAll)) return false;
      to = Reset{static_cast<protocol::ResetScope>(from.reset().scope())};
      return true;
    case v1::Input::kTakeSnapshot:
      to = TakeSnapshot{from.take_snapshot().number()};
      return true;
    case v1::Input::kRestoreSnapshot:
      to = RestoreSnapshot{from.restore_snapshot().number()};
      return true;
    case v1::Input::kAddBody:
      to = AddBody{from.add_body().yaml()};
      return true;
    case v1::Input::kRemoveBody:
      to = RemoveBody{from.remove_body().name()};
      return true;
    case v1::Input::kSpawnModel:
      to = SpawnModel{model_of(from.spawn_model())};
      return std::get<SpawnModel>(to).model != nullptr;
    case v1::Input::kRemoveModel:
      to = RemoveModel{from.remove_model().name()};
      return true;
    case v1::Input::kLoadScene:
      to = LoadScene{scene_of(from.load_scene())};
      return std::get<LoadScene>(to).scene != nullptr;
    case v1::Input::kInjectFault: {
      const auto& w = from.inject_fault();
      to = InjectFault{w.part(), w.kind(), view_of(w.numbers()), w.until_tick()};
      return true;
    }
    case v1::Input::kClearFault: {
      const auto& w = from.clear_fault();
      to = ClearFault{w.part(), w.kind(), w.drive()};
      return true;
    }
    case v1::Input::kRestoreState:  // InputMessage::decode() takes it
    case v1::Input::WHAT_NOT_SET:
      return false;
  }
  return false;
}

std::vector<std::byte> copy_of(const std::string& from) {
  const auto bytes = bytes_of(from);
  return {bytes.begin(), bytes.end()};
}

bool take(const v1::Input& from, State::Edit& to) {
  switch (from.what_case()) {
    case v1::Input::kAddBody:
      to = {State::Edit::Kind::kBodyCame, from.add_body().yaml(), nullptr};
      return true;
    case v1::Input::kRemoveBody:
      to = {State::Edit::Kind::kBodyWent, from.remove_body().name(), nullptr};
      return true;
    case v1::Input::kSpawnModel:
      to = {State::Edit::Kind::kModelCame, {}, model_of(from.spawn_model())};
      return to.model != nullptr;
    case v1::Input::kRemoveModel:
      to = {State::Edit::Kind::kModelWent, from.remove_model().name(), nullptr};
      return true;
    default:
      return false;
  }
}

bool take(const v1::State& from, State& to) {
  to = {from.tick(), from.era(), from.revision(), from.next_snapshot(), copy_of(from.state()), {}, {}};
  for (const auto& kept : from.snapshots()) to.snapshots.push_back({kept.number(), copy_of(kept.state())});
  for (const auto& edit : from.edits())
    if (!take(edit, to.edits.emplace_back())) return false;
  return true;
}

void take(const v1::Build& from, Build& to) {
  to = {from.version(),
        from.commit(),
        from.compiler(),
        from.instruction_set(),
        {from.engines().begin(), from.engines().end()}};
}

}  // namespace

bool decode(Bytes from, Header& to) {
  v1::Header w;
  if (!parse(from, w)) return false;
  to = {w.format(), w.scene_file(), w.scene(), w.engine(), w.clock(),
        w.seed(),   w.tick_ns(),    {},        {},         w.parameters()};
  take(w.build(), to.build);
  for (const auto& file : w.files()) to.files.push_back({file.name(), file.size(), file.crc()});
  take_packages(w, to);
  return true;
}

bool decode(Bytes from, State& to) {
  v1::State w;
  return parse(from, w) && take(w, to);
}

bool decode(Bytes from, protocol::PartSample& to) {
  visum::v1::PartSample w;
  if (!parse(from, w)) return false;
  to.part = w.part();
  to.tick = w.tick();
  to.sim_time_ns = w.sim_time_ns();
  to.era = w.era();
  protocol::wire::take_numbers(w.controller_inputs(), to.controller_inputs);
  protocol::wire::take_numbers(w.sensor_outputs(), to.sensor_outputs);
  return true;
}

bool decode(Bytes from, protocol::PartDescription& to) {
  visum::v1::PartDescription w;
  protocol::PartDescriptionReply reply;
  std::string why;
  if (!parse(from, w) || !protocol::wire::take(w, reply, why)) return false;
  to = std::move(reply.description);
  return true;
}

bool TickMessage::decode(Bytes from) {
  v1::Tick w;
  if (!parse(from, w)) return false;
  fault_ = w.fault();
  tick = {w.tick(), w.era(), w.sim_time_ns(), w.state_hash(), fault_};
  return true;
}

bool LogMessage::decode(Bytes from) {
  v1::LogLine w;
  if (!parse(from, w)) return false;
  level_ = w.level();
  text_ = w.text();
  line = {level_, text_};
  return true;
}

struct InputMessage::Impl {
  v1::Input message;
  State state;  // of a RestoreState
};

InputMessage::InputMessage() : impl_(std::make_unique<Impl>()) {}
InputMessage::~InputMessage() = default;

bool InputMessage::decode(Bytes from) {
  if (!parse(from, impl_->message)) return false;
  input.tick = impl_->message.tick();
  input.era = impl_->message.era();
  if (!impl_->message.has_restore_state()) return take(impl_->message, input.input);
  input.input = RestoreState{&impl_->state};
  return take(impl_->message.restore_state(), impl_->state);
}

}  // namespace visum::recording
