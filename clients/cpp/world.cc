#include "clients/cpp/world.h"

#include <cmath>
#include <stdexcept>

#include "clients/cpp/client_state.h"
#include "protocol/model_bundle.h"

namespace visum {
namespace {

std::vector<double> numbers(const Vector& vector) {
  return {vector.begin(), vector.end()};
}

std::vector<double> numbers(const std::optional<Vector>& vector) {
  return vector ? numbers(*vector) : std::vector<double>();
}

std::vector<double> numbers(const Pose& pose) {
  const auto& [p, q] = pose;
  return {p[0], p[1], p[2], q[0], q[1], q[2], q[3]};
}

std::int64_t ns_of(double seconds) {
  if (!(seconds >= 0.0 && seconds < 1e9)) throw Error(ErrorCode::kMisuse, "a time must be 0 to 1e9 s");
  return std::llround(seconds * 1e9);
}

EventInfo info_of(const protocol::Event& event) {
  return {event.kind, event.text,        event.part, event.source, static_cast<EventLevel>(event.level),
          event.tick, event.sim_time_ns, event.era};
}

SpawnedModel spawn_as(detail::ClientState& state, protocol::SpawnModel model, const SpawnOptions& options) {
  model.name = options.name;
  model.pose = numbers(options.pose);
  model.make_unique = options.unique;
  auto spawned = state.request_as<protocol::ModelSpawned>(model);
  return {std::move(spawned.name), std::move(spawned.bodies), std::move(spawned.parts)};
}

}  // namespace

void WorldControl::pause() {
  client_->state_->request(protocol::Pause{});
}
void WorldControl::resume() {
  client_->state_->request(protocol::Resume{});
}
void WorldControl::step(std::int64_t ticks) {
  client_->state_->request(protocol::Step{ticks});
}
void WorldControl::set_speed(double factor) {
  client_->state_->request(protocol::SetSpeed{factor});
}
void WorldControl::reset(ResetScope scope) {
  client_->state_->request(protocol::Reset{static_cast<protocol::ResetScope>(scope)});
}

std::uint64_t WorldControl::take_snapshot(const std::string& name) {
  return client_->state_->request_as<protocol::SnapshotTaken>(protocol::TakeSnapshot{name}).snapshot;
}
void WorldControl::restore_snapshot(std::uint64_t number) {
  client_->state_->request(protocol::RestoreSnapshot{number});
}
void WorldControl::restore_snapshot(const std::string& name) {
  client_->state_->request(protocol::RestoreSnapshot{0, name});
}
void WorldControl::start_recording(const std::string& name) {
  client_->state_->request(protocol::StartRecording{name});
}
void WorldControl::stop_recording() {
  client_->state_->request(protocol::StopRecording{});
}

void WorldControl::push_body(const std::string& body, const Vector& force_n, double duration_s,
                             const Vector& torque_nm, const std::optional<Vector>& point_m) {
  client_->state_->request(
      protocol::PushBody{body, numbers(force_n), numbers(torque_nm), numbers(point_m), ns_of(duration_s)});
}

void WorldControl::set_body(const std::string& body, const std::optional<Pose>& pose, const Motion& motion,
                            bool keeps_moving) {
  auto velocity = numbers(motion.velocity);
  velocity.insert(velocity.end(), motion.turn_rate.begin(), motion.turn_rate.end());
  client_->state_->request(protocol::SetBody{body, pose ? numbers(*pose) : std::vector<double>(),
                                             std::move(velocity), keeps_moving});
}

void WorldControl::set_joints(const std::string& model, const std::map<std::string, double>& positions,
                              const std::map<std::string, double>& velocities, bool keeps_moving) {
  for (const auto& [name, velocity] : velocities)
    if (!positions.contains(name))
      throw Error(ErrorCode::kMisuse, "joint '" + name + "' has a velocity and no position");
  protocol::SetJoints request{model, {}, keeps_moving};
  for (const auto& [name, position] : positions) {
    const auto velocity = velocities.find(name);
    request.joints.push_back({name, position, velocity == velocities.end() ? 0.0 : velocity->second});
  }
  client_->state_->request(request);
}

void WorldControl::pull_body(const std::string& body, const Vector& target_m, double max_force_n,
                             double duration_s, const std::optional<Vector>& point_m) {
  client_->state_->request(
      protocol::PullBody{body, numbers(point_m), numbers(target_m), max_force_n, ns_of(duration_s)});
}
void WorldControl::release_body(const std::string& body) {
  client_->state_->request(protocol::ReleaseBody{body});
}
void WorldControl::add_body(const std::string& yaml) {
  client_->state_->request(protocol::AddBody{yaml});
}
void WorldControl::remove_body(const std::string& name) {
  client_->state_->request(protocol::RemoveBody{name});
}

std::vector<std::string> WorldControl::models() {
  return client_->state_->request_as<protocol::ModelList>(protocol::ListModels{}).files;
}
std::vector<std::string> WorldControl::spawned_models() {
  return client_->state_->request_as<protocol::ModelList>(protocol::ListModels{}).spawned;
}

SpawnedModel WorldControl::spawn(const std::string& model, const SpawnOptions& options) {
  return spawn_as(*client_->state_, protocol::SpawnModel{model}, options);
}

SpawnedModel WorldControl::spawn_file(const std::filesystem::path& file, const SpawnOptions& options) {
  protocol::SpawnModel model;
  try {
    model = protocol::bundle_of_model(file);
  } catch (const std::runtime_error& error) {
    throw Error(ErrorCode::kMisuse, error.what());
  }
  return spawn_as(*client_->state_, std::move(model), options);
}

void WorldControl::remove_model(const std::string& name) {
  client_->state_->request(protocol::RemoveModel{name});
}

void WorldControl::run_scenario(const std::string& name, double timeout_s) {
  client_->state_->request(protocol::RunScenario{name, ns_of(timeout_s)});
}
void WorldControl::stop_scenario() {
  client_->state_->request(protocol::StopScenario{});
}
ScenarioInfo WorldControl::scenario() {
  const auto state = client_->state_->request_as<protocol::ScenarioState>(protocol::ReadScenario{});
  ScenarioInfo info{state.name,      state.running, static_cast<ScenarioVerdict>(state.verdict),
                    state.exit_code, state.text,    {},
                    state.state_hash};
  for (const auto& check : state.checks) info.checks.push_back({check.name, check.passed, check.text});
  return info;
}

std::vector<std::string> WorldControl::scenes() {
  return client_->state_->request_as<protocol::SceneList>(protocol::ListScenes{}).scenes;
}

std::vector<std::string> WorldControl::scenarios() {
  return client_->state_->request_as<protocol::SceneList>(protocol::ListScenes{}).scenarios;
}

void WorldControl::load_scene(const std::string& scene) {
  client_->state_->request(protocol::LoadScene{scene});
}

std::vector<EventInfo> WorldControl::subscribe_events(EventLevel level) {
  const auto kept = client_->state_->request_as<protocol::EventList>(
      protocol::SubscribeEvents{static_cast<protocol::EventLevel>(level)});
  std::vector<EventInfo> events;
  for (const auto& event : kept.events) events.push_back(info_of(event));
  return events;
}
void WorldControl::unsubscribe_events() {
  client_->state_->request(protocol::UnsubscribeEvents{});
}

std::vector<EventInfo> WorldControl::events() {
  std::vector<EventInfo> events;
  try {
    while (const auto came = client_->state_->link().next(std::chrono::milliseconds(0)))
      if (const auto* event = std::get_if<protocol::Event>(&*came)) events.push_back(info_of(*event));
  } catch (const protocol::ConnectionError& error) {
    throw Error(ErrorCode::kConnection, error.what());
  }
  return events;
}

void WorldControl::announce(const std::string& text, bool is_check, EventLevel level) {
  client_->state_->request(
      protocol::Announce{text, is_check ? "check" : "line", static_cast<protocol::EventLevel>(level)});
}

}  // namespace visum
