// The messages of the port protocol as plain values: one struct per message of visum.proto, with the same
// names and the same meaning. Their comments stand in visum.proto and in SPEC.md and are not repeated here.
// codec.h turns these structs into frames, so that Protobuf's headers stay inside protocol/.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "protocol/fault_messages.h"
#include "protocol/model_messages.h"
#include "protocol/module_messages.h"
#include "protocol/part_description.h"
#include "protocol/reset_scope.h"
#include "protocol/scenario_messages.h"
#include "protocol/scene_messages.h"

namespace visum::protocol {

enum class Role { kUnspecified = 0, kObserver = 1, kController = 2, kAdmin = 3 };

enum class ErrorCode {
  kUnspecified = 0,
  kMalformed = 1,
  kTooLarge = 2,
  kVersion = 3,
  kUnauthenticated = 4,
  kForbidden = 5,
  kBusy = 6,
  kUnknownName = 7,
  kNoLease = 8,
  kLeased = 9,
  kBadValue = 10,
  kStale = 11,
  kWrongState = 12,
  kTimeout = 13,
  kFrozen = 14,
  kInternal = 15,
};
const char* to_string(ErrorCode code);  // "bad value", ...
const char* to_string(Role role);       // "observer", ...

// ---------------------------------------- client to server

struct Hello {
  std::uint32_t min_version = 1, max_version = 1;
  std::string client_name;
  Role role = Role::kObserver;
  std::string token;
};
struct Status {};
struct ListParts {};
struct DescribePart {
  std::string part;
};
struct AcquireLease {
  std::string part;
  std::int64_t deadline_ns = 0;
  bool take = false;
};
struct ReleaseLease {
  std::string part;
};
struct Write {
  std::string part;
  std::uint32_t first_port = 0;
  std::vector<double> values;
  std::uint64_t sequence = 0;
};
struct Read {
  std::string part;
};
struct Subscribe {
  std::string part;
  std::uint32_t every_n_ticks = 1;
};
struct Unsubscribe {
  std::string part;
};
struct GetParameters {
  std::string part;
};
struct SetParameter {
  std::string part, name;
  ParameterValue value;
};
struct ReadBlackboard {
  std::string part, name;
  std::uint64_t offset = 0, length = 0;
};
struct WriteBlackboard {
  std::string part, name;
  std::uint64_t offset = 0;
  std::vector<std::byte> data;
};
struct LockBlackboard {
  std::string part, name;
  std::int64_t timeout_ns = 0;
};
struct UnlockBlackboard {
  std::string part, name;
  bool discard = false;
};
enum class OnTimeout : std::uint32_t { kEnd = 0, kHold = 1, kStop = 2, kFree = 3 };
struct Gate {
  std::string part, client;
  std::int64_t period_ns = 0;
  std::uint32_t module = 0;
  std::vector<std::byte> frame{};
};
struct Join {
  std::int64_t timeout_ns = 0;
  std::uint32_t grade = 0;
  OnTimeout on_timeout = OnTimeout::kEnd;
  std::optional<Gate> gate{};
  std::vector<std::string> parts{};
};
struct Stream {
  std::uint32_t port = 0;
  std::uint64_t written = 0, heard = 0;
};
struct Advance {
  std::int64_t ticks = 1;
  bool follow_buses = false;
  std::uint64_t bus_said = 0;
  std::vector<Stream> streams{};
  std::uint32_t members = 0;
  bool answer_may_wait = false;
};
struct Leave {};
struct Note {
  std::string text;
};
struct DescribeWorld {};
struct ReadWorld {};
struct SubscribeWorld {
  std::uint32_t every_n_ticks = 1;
};
struct UnsubscribeWorld {};
struct ReadMesh {
  std::uint32_t mesh = 0;
};
struct ReadTexture {
  std::uint32_t texture = 0;
};
struct Pause {};
struct Resume {};
struct Step {
  std::int64_t ticks = 1;
};
struct SetSpeed {
  double factor = 1.0;
};
struct Reset {
  ResetScope scope = ResetScope::kWorld;
};
struct TakeSnapshot {
  std::string name{};
};
struct RestoreSnapshot {
  std::uint64_t snapshot = 0;
  std::string name{};
};
struct StartRecording {
  std::string name;
};
struct StopRecording {};
enum class EventLevel : std::uint32_t { kUnspecified = 0, kDebug = 1, kInfo = 2, kWarning = 3, kError = 4 };
const char* to_string(EventLevel level);  // "debug", ...
struct SubscribeEvents {
  EventLevel level = EventLevel::kUnspecified;
};
struct UnsubscribeEvents {};
struct Announce {
  std::string text, kind{};
  EventLevel level = EventLevel::kUnspecified;
};
struct PushBody {
  std::string body;
  std::vector<double> force_n, torque_nm, point_m;
  std::int64_t duration_ns = 0;
};
struct SetBody {
  std::string body;
  std::vector<double> pose, velocity;
  bool keeps_moving = false;
};
struct JointTarget {
  std::string name;
  double position = 0.0, velocity = 0.0;
};
struct SetJoints {
  std::string model;
  std::vector<JointTarget> joints;
  bool keeps_moving = false;
};
struct PullBody {
  std::string body;
  std::vector<double> point_m, target_m;
  double max_force_n = 0.0;
  std::int64_t duration_ns = 0;
};
struct ReleaseBody {
  std::string body;
};
struct AddBody {
  std::string yaml;
};
struct RemoveBody {
  std::string body;
};
struct Shutdown {};
using Request =
    std::variant<Hello, Status, ListParts, DescribePart, AcquireLease, ReleaseLease, Write, Read, Subscribe,
                 Unsubscribe, GetParameters, SetParameter, ReadBlackboard, WriteBlackboard, Join, Advance,
                 Leave, Note, DescribeWorld, ReadWorld, SubscribeWorld, UnsubscribeWorld, ReadMesh,
                 ReadTexture, Pause, Resume, Step, SetSpeed, Reset, TakeSnapshot, RestoreSnapshot, PushBody,
                 AddBody, RemoveBody, Shutdown, InjectFault, ClearFault, ListFaults, SetBody, SetJoints,
                 PullBody, ReleaseBody, SubscribeEvents, UnsubscribeEvents, Announce, StartRecording,
                 StopRecording, AnnounceModules, ReportModules, ListModules, OverrideModulePort,
                 LockBlackboard, UnlockBlackboard, SpawnModel, RemoveModel, ListModels, ListScenes, LoadScene,
                 RunScenario, StopScenario, ReadScenario, SetModuleParameter>;

// ---------------------------------------- server to client

struct Error {
  ErrorCode code = ErrorCode::kUnspecified;
  std::string text;
  std::string owner;
};
struct Ok {
  std::int64_t acts_at_tick = 0;  // 0: it is done
};
struct Welcome {
  std::uint32_t version = 1;
  std::string server;
  std::uint64_t session = 0;
  Role role = Role::kObserver;
  std::int64_t tick_ns = 0;
  std::string scene;
  std::string clock;
  bool simulated = true;
};
struct LockstepMember {
  std::string client;
  std::int64_t granted_tick = 0;
  std::int64_t waiting_ns = 0;
  std::uint32_t grade = 0;
  std::string note{};
};
struct PhaseTime {
  std::string name;
  std::int64_t mean_ns = 0, max_ns = 0;
};
struct PartBus {
  std::string part, name;  // "arm", "pty:/tmp/arm.tty"
};
struct Exchange {
  std::string name;
  std::uint64_t count = 0;
};
struct ServerStatus {
  std::int64_t tick = 0, sim_time_ns = 0;
  std::uint64_t era = 0;
  bool paused = false, frozen = false;
  std::string frozen_reason;
  std::string clock;
  double speed = 1.0, real_time_factor = 0.0;
  std::uint64_t overruns = 0;
  std::int64_t lateness_p50_ns = 0, lateness_p999_ns = 0, lateness_max_ns = 0;
  std::uint64_t state_hash = 0;
  std::uint32_t sessions = 0;
  std::vector<LockstepMember> lockstep;
  std::vector<PhaseTime> phases;
  std::uint64_t refused = 0;
  std::int64_t own_allocations = -1;
  std::vector<PartBus> buses;
  std::string stuck_node;  // empty: none
  std::int64_t stuck_ns = 0;
  std::vector<std::string> free_running{};
  std::uint64_t solver_warnings = 0;
  std::vector<Exchange> exchanges{};      // by client
  std::vector<Exchange> bus_exchanges{};  // by part
  std::uint64_t bus_drops = 0;
  std::string working{};  // empty: no tick takes long
  std::int64_t working_ns = 0;
  std::uint64_t silent_stops = 0, late_writes = 0;
  std::uint64_t limited_ticks = 0;
  std::vector<std::string> limited_bodies{};
};
struct PartSummary {
  std::string name, kind, lease_owner;
};
struct PartList {
  std::vector<PartSummary> parts;
};
struct PartDescriptionReply {
  PartDescription description;
  std::string lease_owner;
};
struct LeaseGrant {
  std::string part;
  std::uint64_t epoch = 0;
};
struct PartSample {
  std::string part;
  std::int64_t tick = 0, sim_time_ns = 0;
  std::uint64_t era = 0;
  std::vector<double> controller_inputs, sensor_outputs;
  std::uint64_t conflated = 0;
};
struct ParameterList {
  std::vector<Parameter> parameters;
};
struct BlackboardData {
  std::uint64_t offset = 0, total = 0;
  std::vector<std::byte> data;
  std::uint64_t generation = 0;
};
struct Advanced {
  std::int64_t tick = 0, sim_time_ns = 0;
  std::uint64_t era = 0;
  std::uint64_t bus_said = 0;
  std::vector<Stream> streams{};
};
struct ShapeDescription {
  std::string kind;
  std::vector<double> size, pose, color;
  std::uint32_t mesh = 0;
  std::string surface;
  bool collides = true;
  std::uint32_t material = 0;
};
struct BodyDescription {
  std::string name, model;
  bool fixed = false;
  double mass_kg = 0.0;
  std::vector<ShapeDescription> shapes;
  std::string engine;
  std::vector<double> com;
  bool kinematic = false;
};
struct JointDescription {
  std::string name, type, parent, child;
  double lower = 0.0, upper = 0.0;
  std::string part;
  std::vector<double> pose, axis;
};
struct MaterialDescription {
  std::string name;
  double roughness = 0.0, metalness = 0.0;
  std::uint32_t texture = 0;
  std::vector<double> texture_size;
};
struct LightDescription {
  std::string name, kind;
  std::vector<double> color;
  double intensity = 0.0;
  std::vector<double> position, direction;
  double angle = 0.0;
  bool shadows = false;
};
struct ViewpointDescription {
  std::string name;
  std::vector<double> position, target;
  double fov = 0.0;
};
struct PanelDescription {
  std::string name, text;
};
struct SensorDescription {
  std::string part, kind, body;
  std::vector<double> pose, range, angle;
  double fov = 0.0, aspect = 0.0;
};
struct WorldDescription {
  std::string scene;
  std::int64_t tick_ns = 0;
  std::vector<double> gravity;
  std::vector<BodyDescription> bodies;
  std::vector<JointDescription> joints;
  std::uint64_t revision = 0;
  std::vector<MaterialDescription> materials;
  std::vector<LightDescription> lights;
  std::vector<ViewpointDescription> viewpoints;
  std::vector<PanelDescription> panels;
  std::vector<std::string> losses;
  std::vector<SensorDescription> sensors;
};
struct MeshData {
  std::vector<float> vertices;
  std::vector<std::uint32_t> triangles;
};
struct TextureData {
  std::string content_type;
  std::vector<std::byte> data;
};
struct ContactSample {
  std::uint32_t body_a = 0, body_b = 0;
  std::vector<double> position, normal;  // 3 each
  double depth = 0.0, normal_force_n = 0.0;
};
struct WorldSample {
  std::int64_t tick = 0, sim_time_ns = 0;
  std::uint64_t era = 0;
  std::vector<double> poses, velocities;  // 7 and 6 per body
  std::vector<double> joint_positions, joint_velocities, joint_efforts, following_errors;
  std::vector<double> peak_following_errors, peak_contact_forces;
  std::vector<ContactSample> contacts;
  std::uint64_t state_hash = 0, revision = 0, conflated = 0;
};
struct SnapshotTaken {
  std::uint64_t snapshot = 0;
  std::int64_t tick = 0;
  std::uint64_t state_hash = 0;
};
struct Event {
  std::string kind, text, part;
  std::uint64_t era = 0;
  std::int64_t tick = 0;
  EventLevel level = EventLevel::kUnspecified;
  std::string source{};
  std::int64_t sim_time_ns = 0;
};
struct EventList {
  std::vector<Event> events;
};

using Reply =
    std::variant<Error, Ok, Welcome, ServerStatus, PartList, PartDescriptionReply, LeaseGrant, PartSample,
                 ParameterList, BlackboardData, Advanced, WorldDescription, WorldSample, MeshData,
                 SnapshotTaken, Event, TextureData, FaultList, EventList, ModuleList, OverrideModulePort,
                 ModelSpawned, ModelList, SceneList, SetModuleParameter, ScenarioState>;

}  // namespace visum::protocol
