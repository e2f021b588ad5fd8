// The world as a whole: its time, its bodies and models, snapshots, recordings, and what happens in it.
//
//   visum::Client client("127.0.0.1:1500", {.name = "test_bench", .role = visum::Role::kAdmin});
//   visum::WorldControl world(client);
//   world.spawn("cart/cart.yaml", {.name = "second", .pose = {{0, 2, 0}}});
//   visum::Part cart = client.part("second");
//   world.push_body("second/chassis", {20, 0, 0}, 0.5);
//
// Lengths are in metres, angles in radians, poses and vectors in the world frame. Functions need the
// role admin, unless they say another one. Calls block for one round trip. The thread rules are those of
// the Client, and every failure throws visum::Error.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "clients/cpp/kinematics.h"
#include "clients/cpp/visum.h"

namespace visum {

using Vector = std::array<double, 3>;

// A reset takes back time and state, one of them, everything that came since the scene was loaded, or all.
enum class ResetScope { kWorld = 0, kTime = 1, kState = 2, kSpawned = 3, kAll = 4 };

struct Motion {
  Vector velocity{};   // m/s, of the link frame's origin
  Vector turn_rate{};  // rad/s
};

struct SpawnOptions {
  std::string name = {};  // in the world; empty: the file's
  Pose pose = {};         // of the model's origin
  bool unique = false;    // put a number behind a name that is taken, instead of an error
};

// A model that came: its name, and those of its bodies and parts, with its sensors.
struct SpawnedModel {
  std::string name;
  std::vector<std::string> bodies, parts;
};

enum class EventLevel { kDebug = 1, kInfo = 2, kWarning = 3, kError = 4 };

struct EventInfo {
  std::string kind;  // "lease_lost", "world_changed", "log", ...: as `visum events` shows them
  std::string text, part, source;
  EventLevel level = EventLevel::kInfo;
  std::int64_t tick = 0, time_ns = 0;
  std::uint64_t era = 0;
};

// A scenario has passed, has failed, or is invalid: neither success nor failure means anything.
enum class ScenarioVerdict { kNone = 0, kPassed = 1, kFailed = 2, kInvalid = 3 };

struct ScenarioInfo {
  std::string name;  // empty: the server has run none yet
  bool running = false;
  ScenarioVerdict verdict = ScenarioVerdict::kNone;  // once it has ended
  int exit_code = 0;                                 // of `visum run`
  std::string text;                                  // how it ended
  struct Check {
    std::string name;
    bool passed = false;
    std::string text;
  };
  std::vector<Check> checks;  // whose results are certain
  std::uint64_t state_hash = 0;
};

// A view of a Client, which must outlive it.
class WorldControl {
 public:
  explicit WorldControl(Client& client) : client_(&client) {}

  void pause();
  void resume();
  void step(std::int64_t ticks);  // while paused; returns once they are done
  void set_speed(double factor);  // realtime: simulated seconds per second of wall time
  // Begins a new era, but for kSpawned.
  void reset(ResetScope scope = ResetScope::kWorld);

  // Returns the snapshot's number. With a name, which begins with a letter, it is also a file of the server.
  std::uint64_t take_snapshot(const std::string& name = {});
  void restore_snapshot(std::uint64_t number);
  void restore_snapshot(const std::string& name);
  // Into a file of the server; the name begins with a letter.
  void start_recording(const std::string& name);
  void stop_recording();

  // Pushes a body for so long, at its centre of mass or at a point.
  void push_body(const std::string& body, const Vector& force_n, double duration_s,
                 const Vector& torque_nm = {}, const std::optional<Vector>& point_m = {});
  // Puts the link frame of a free or kinematic body elsewhere (nothing: it stays), with all that hangs on it.
  // A kinematic body keeps the motion until it is set again or this session ends, unless `keeps_moving`.
  void set_body(const std::string& body, const std::optional<Pose>& pose, const Motion& motion = {},
                bool keeps_moving = false);
  // Sets joints of a model, rad or m, and those that follow them. Velocities of joints that are not named
  // are 0.
  void set_joints(const std::string& model, const std::map<std::string, double>& positions,
                  const std::map<std::string, double>& velocities = {}, bool keeps_moving = false);
  // Pulls a point of a body (in its link frame; nothing: the centre of mass) to a target by a damped spring.
  // 0 s: until release_body(), or the session ends.
  void pull_body(const std::string& body, const Vector& target_m, double max_force_n, double duration_s = 0.0,
                 const std::optional<Vector>& point_m = {});
  void release_body(const std::string& body);

  // Adds a body, given as one entry of a scene's `bodies:`.
  void add_body(const std::string& yaml);
  void remove_body(const std::string& name);
  // Models of the server, for spawn().
  std::vector<std::string> models();
  std::vector<std::string> spawned_models();
  // Brings one of models() into the world, with its parts, drives and sensors; or a file of this machine,
  // which is sent with the files that it names.
  SpawnedModel spawn(const std::string& model, const SpawnOptions& options = {});
  SpawnedModel spawn_file(const std::filesystem::path& file, const SpawnOptions& options = {});
  void remove_model(const std::string& name);

  // Lets the server run a scenario of its installation beside its world, in a world of its own, for at most
  // so many seconds of wall time (0: an hour). One at a time.
  void run_scenario(const std::string& name, double timeout_s = 0.0);
  void stop_scenario();
  // The one that runs, or ran last. Any role.
  ScenarioInfo scenario();

  // Scenes of the server, for load_scene(), and its scenarios. Any role.
  std::vector<std::string> scenes();
  std::vector<std::string> scenarios();
  // Puts another scene in the world's place, and begins a new era at time 0. Parts and leases of the scene
  // before are gone: ask the Client for the new parts.
  void load_scene(const std::string& scene);

  // Events of at least that level; returns those that happened before. Any role.
  std::vector<EventInfo> subscribe_events(EventLevel level = EventLevel::kInfo);
  void unsubscribe_events();
  // Returns those that came since the last call.
  std::vector<EventInfo> events();
  // Tells those who subscribed a line, or the result of a check. Role controller.
  void announce(const std::string& text, bool is_check = false, EventLevel level = EventLevel::kInfo);

 private:
  Client* client_;
};

}  // namespace visum
