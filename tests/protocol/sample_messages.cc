#include "tests/protocol/sample_messages.h"

#include <limits>

namespace visum::testing {
namespace {

using namespace protocol;

std::vector<std::byte> bytes(std::initializer_list<int> values) {
  std::vector<std::byte> result;
  for (const int value : values) result.push_back(static_cast<std::byte>(value));
  return result;
}

PartDescription arm() {
  PartDescription part{"arm", "amtec_arm", {}, {}, {}, {}};
  // The first port of each vector has every field, so names of values and of bits, too.
  part.controller_inputs = {
      {"Desired Angle 1", "rad", -3.5, 3.5, 0.25, "Desired Angle", {{1, "one"}, {2, "two"}}, {{3, "ready"}}},
      {"Reset", "", 0.0, 4294967295.0, 1.0, "Reset"}};
  part.sensor_outputs = {
      {"Actual Angle 1", "rad", -7.0, 7.0, 0.125, "Actual Angle", {{-1, "left"}}, {{1, "HOME_OK"}}}};
  part.parameters = {{"loss_reaction",
                      "1",
                      "What a lost controller causes",
                      std::string("stop"),
                      -1,
                      1,
                      {"stop", "hold"},
                      true},
                     {"cycles", "1", "Cycles since start", std::int64_t{-42}, -100, 100, {}, false}};
  part.blackboards = {{"log", "text/plain", 1, 12, 4096, true}};
  return part;
}

ServerStatus status() {
  ServerStatus s;
  s.tick = 1234;
  s.sim_time_ns = 1'234'000'000;
  s.era = 2;
  s.paused = s.frozen = true;
  s.frozen_reason = "the position of arm/link_3 is not finite";
  s.clock = "lockstep";
  s.speed = 2.0;
  s.real_time_factor = 1.5;
  s.overruns = 3;
  s.lateness_p50_ns = 40'000;
  s.lateness_p999_ns = 900'000;
  s.lateness_max_ns = 2'000'000;
  s.state_hash = 0x9f00000000000001;
  s.sessions = 4;
  s.lockstep = {{"pick_and_place", 1240, 5'000'000, 2, "waits for thread 7"}};
  s.phases = {{"sense", 1000, 2000}, {"step", 30'000, 90'000}};
  s.refused = 7;
  s.own_allocations = 6;
  s.buses = {{"arm", "pty:/tmp/arm.tty"}, {"arm", "tcp:40123"}};
  s.stuck_node = "agent 'explorer'";
  s.stuck_ns = 1'200'000'000;
  s.free_running = {"joystick", "page"};
  s.solver_warnings = 5;
  s.exchanges = {{"pick_and_place", 2400}, {"page", 3}};
  s.bus_exchanges = {{"arm", 17}};
  s.bus_drops = 12;
  s.working = "engine 'impulse': box, sphere (2 bodies)";
  s.working_ns = 700'000'000;
  s.silent_stops = 1;
  s.late_writes = 8;
  s.limited_ticks = 3;
  s.limited_bodies = {"arm/lower_arm", "box"};
  return s;
}

AnnounceModules announced() {
  AnnounceModules announced{
      "motion",
      5'000'000,
      {{"Arm", true, {"Speed"}, {"Current"}, {"Load"}, {"Force"}},
       {"Arm/Ramp", false, {"Desired Angle 1"}, {"Target 1"}, {"Actual Angle 1"}, {"Angle 1"}}},
      {{{"motion", "Arm", ModuleVector::kControllerInput, 1},
        {"motion", "Arm/Ramp", ModuleVector::kSensorOutput, 2},
        3}},
      "127.0.0.1:40123"};
  for (auto& module : announced.modules) module.parameters = arm().parameters;
  announced.blackboards = {{"Way", "application/x-float64", 64, 11, 704, true}};
  return announced;
}

ReportModules reported() {
  return {"motion",
          15'000'000,
          {{{0.5}, {0.25}, {-0.5}, {0.125}, 1500, 700, {1}, {0.5, std::int64_t{3}, true, "slow"}}},
          {{11, 7, bytes({0, 1, 254})}}};
}

WorldDescription world() {
  WorldDescription w;
  w.scene = "amtec_arm";
  w.tick_ns = 1'000'000;
  w.gravity = {0, 0, -9.81};
  w.bodies = {{"box",
               "box",
               true,
               0.5,
               {{"box", {0.1, 0.1, 0.1}, {0, 0, 0.5, 1, 0, 0, 0}, {1, 0, 0, 1}, 2, "wood", true, 1}},
               "ode",
               {0, 0, 0.01},
               true}};
  w.joints = {{"arm/joint_1",
               "hinge",
               "arm/base",
               "arm/link_1",
               -2.0,
               2.0,
               "arm",
               {0, 0, 0.1, 1, 0, 0, 0},
               {0, 0, 1}}};
  w.materials = {{"steel", 0.3, 0.9, 1, {0.5, 0.25}}};
  w.lights = {{"sun", "spot", {1, 0.9, 0.8}, 2.5, {0, 0, 3}, {0, 0, -1}, 0.5, true}};
  w.viewpoints = {{"from above", {0, 0, 2}, {0.1, 0, 0}, 0.7}};
  w.panels = {{"Jog", "{\"visum_panel\": 1}"}};
  w.losses = {"model 'arm': a camera is not simulated"};
  w.sensors = {{"eye", "scanner", "box", {0, 0, 0.1, 1, 0, 0, 0}, {0.05, 8}, {-1.5, 1.5}, 0.5, 2.0},
               {"camera", "camera", "", {1, 2, 3, 1, 0, 0, 0}, {0, 100}, {}, 1.25, 1.5}};
  w.revision = 5;
  return w;
}

WorldSample sample() {
  WorldSample w;
  w.tick = 100;
  w.sim_time_ns = 100'000'000;
  w.era = 1;
  w.poses = {0, 0, 0.5, 1, 0, 0, 0};
  w.velocities = {0, 0, -0.1, 0, 0, 0.5};
  w.joint_positions = {0.25};
  w.joint_velocities = {0.5};
  w.joint_efforts = {12.5};
  w.following_errors = {-0.001};
  w.peak_following_errors = {0.002};
  w.peak_contact_forces = {4.9};
  w.contacts = {{1, 2, {0.1, 0.2, 0.3}, {0, 0, 1}, 0.0001, 4.905}};
  w.state_hash = std::numeric_limits<std::uint64_t>::max();
  w.revision = 5;
  w.conflated = 9;
  return w;
}

}  // namespace

Samples<Request> sample_requests() {
  return {
      {"hello", Hello{1, 2, "pick_and_place", Role::kController, "secret"}},
      {"status", Status{}},
      {"list_parts", ListParts{}},
      {"describe_part", DescribePart{"arm"}},
      {"acquire_lease", AcquireLease{"arm", 50'000'000, true}},
      {"release_lease", ReleaseLease{"arm"}},
      {"write", Write{"arm", 7, {0.5, -1.25, 1e-300, 5e-324}, 42}},
      {"read", Read{"arm"}},
      {"subscribe", Subscribe{"arm", 10}},
      {"unsubscribe", Unsubscribe{"arm"}},
      {"get_parameters", GetParameters{"arm"}},
      {"set_parameter_number", SetParameter{"arm", "max_current", 2.5}},
      {"set_parameter_integer", SetParameter{"arm", "cycles", std::numeric_limits<std::int64_t>::min()}},
      {"set_parameter_flag", SetParameter{"arm", "brake", true}},
      {"set_parameter_text", SetParameter{"arm", "loss_reaction", std::string("h\xC3\xB6ld")}},
      {"read_blackboard", ReadBlackboard{"arm", "log", 16, 32}},
      {"write_blackboard", WriteBlackboard{"arm", "log", 4, bytes({0, 255, 10, 0})}},
      {"join", Join{2'000'000'000,
                    1,
                    OnTimeout::kFree,
                    Gate{"arm", "poller", 20'000'000, 3, {std::byte{0x0B}, std::byte{0x10}}},
                    {"arm", "gripper"}}},
      {"advance", Advance{10, true, 77, {{40123, 1'234'567'890'123, 17}}, 4, true}},
      {"leave", Leave{}},
      {"describe_world", DescribeWorld{}},
      {"read_world", ReadWorld{}},
      {"subscribe_world", SubscribeWorld{33}},
      {"unsubscribe_world", UnsubscribeWorld{}},
      {"read_mesh", ReadMesh{3}},
      {"pause", Pause{}},
      {"resume", Resume{}},
      {"step", Step{5}},
      {"set_speed", SetSpeed{0.5}},
      {"reset", Reset{ResetScope::kState}},
      {"reset_all", Reset{ResetScope::kAll}},
      {"take_snapshot", TakeSnapshot{"monday"}},
      {"restore_snapshot", RestoreSnapshot{2, "monday"}},
      {"push_body", PushBody{"box", {1, 0, 0}, {0, 0.5, 0}, {0, 0, 0.1}, 100'000'000}},
      {"set_body", SetBody{"box", {0.5, 0, 0.1, 1, 0, 0, 0}, {0, 0, 0.25, 0, 1, 0}, true}},
      {"set_joints", SetJoints{"arm", {{"joint_1", 0.5, -0.25}, {"joint_2", -1.0, 0.0}}, true}},
      {"pull_body", PullBody{"box", {0, 0, 0.05}, {0.5, 0.25, 1}, 20.0, 2'000'000'000}},
      {"release_body", ReleaseBody{"box"}},
      {"subscribe_events", SubscribeEvents{EventLevel::kWarning}},
      {"unsubscribe_events", UnsubscribeEvents{}},
      {"announce", Announce{"the box is gripped", "check", EventLevel::kError}},
      {"start_recording", StartRecording{"monday"}},
      {"stop_recording", StopRecording{}},
      {"add_body", AddBody{"name: ball\nshape: {sphere: 0.1}\n"}},
      {"remove_body", RemoveBody{"box"}},
      {"shutdown", Shutdown{}},
      {"read_texture", ReadTexture{2}},
      {"note", Note{"waits for thread 7"}},
      {"inject_fault", InjectFault{"arm", "encoder_offset", {{"joint", 3}, {"offset", 0.01}}, 2'000'000'000}},
      {"clear_fault", ClearFault{"arm", "encoder_offset", 3}},
      {"list_faults", ListFaults{"arm"}},
      {"announce_modules", announced()},
      {"report_modules", reported()},
      {"list_modules", ListModules{"motion", 7}},
      {"override_module_port", OverrideModulePort{"motion", "Arm/Ramp", "Actual Angle 1", 0.25, true}},
      {"lock_blackboard", LockBlackboard{"arm", "Trajectory", 500'000'000}},
      {"unlock_blackboard", UnlockBlackboard{"arm", "Trajectory", true}},
      {"spawn_model", SpawnModel{"robot/arm.urdf",
                                 "second",
                                 {0, 2, 0.5, 1, 0, 0, 0},
                                 true,
                                 {{"robot/arm.urdf", "<robot/>"}, {"robot/link.stl", "solid"}}}},
      {"remove_model", RemoveModel{"second"}},
      {"list_models", ListModels{}},
      {"list_scenes", ListScenes{}},
      {"load_scene", LoadScene{"cart"}},
      {"run_scenario", RunScenario{"pick_and_place", 60'000'000'000}},
      {"stop_scenario", StopScenario{}},
      {"read_scenario", ReadScenario{}},
      {"set_module_parameter", SetModuleParameter{"motion", "Arm/Ramp", "Speed", 0.25}},
  };
}

Samples<Reply> sample_replies() {
  return {
      {"error", Error{ErrorCode::kLeased, "'arm' is leased by panel", "panel"}},
      {"ok", Ok{812}},
      {"welcome",
       Welcome{1, "visumd 0.1.0", 17, Role::kController, 1'000'000, "amtec_arm", "realtime", true}},
      {"status", status()},
      {"parts", PartList{{{"arm", "amtec_arm", "panel"}, {"cart", "cart", ""}}}},
      {"part_description", PartDescriptionReply{arm(), "panel"}},
      {"lease", LeaseGrant{"arm", 3}},
      {"part_sample", PartSample{"arm", 12, 12'000'000, 1, {0.5, 1.5}, {0.25, -0.25, 65536.0}, 2}},
      {"parameters", ParameterList{arm().parameters}},
      {"blackboard", BlackboardData{4, 16, bytes({1, 2, 0, 254}), 8}},
      {"advanced", Advanced{20, 20'000'000, 1, 78, {{40123, 17, 9}, {40125, 8, 7}}}},
      {"world_description", world()},
      {"world_sample", sample()},
      {"mesh", MeshData{{0, 0, 0, 1, 0, 0, 0, 1, 0.5f}, {0, 1, 2}}},
      {"snapshot", SnapshotTaken{2, 100, 0xdeadbeefcafe}},
      {"event",
       Event{"lease_lost", "pick_and_place is gone", "arm", 1, 77, EventLevel::kWarning, "arm", 77'000'000}},
      {"events", EventList{{{"log", "the world stands", "arm", 1, 5, EventLevel::kDebug, "visumd", 5'000'000},
                            {"check", "gripped", "arm", 2, 9, EventLevel::kError, "runner", 9'000'000}}}},
      {"texture", TextureData{"image/png", bytes({137, 80, 78, 71})}},
      {"faults", FaultList{{{"torque_lost",
                             "drive",
                             "less torque",
                             {{"offset", "<u>", -1, 1, true, 0.5}, {"share", "", 0, 1, false, 1}}}},
                           {{"arm", "torque_lost", {{"joint", 3}, {"share", 0.5}}, 1200}}}},
      {"modules", ModuleList{7, {{"motion controller", announced(), reported()}}}},
      {"override_module_port", OverrideModulePort{"motion", "Arm/Ramp", "Actual Angle 1", 0.25, true}},
      {"model_spawned", ModelSpawned{"second", {"second/base", "second/link"}, {"second", "eye"}}},
      {"scenario", ScenarioState{"pick_and_place",
                                 true,
                                 ScenarioVerdict::kFailed,
                                 1,
                                 "1 of 2 checks",
                                 {{"stands", true, "tilt is 0"}, {"rests", false, "too fast"}},
                                 0x9f3c0a5be2d81746}},
      {"models", ModelList{{"cart/cart.yaml", "two_link/two_link.urdf"}, {"second"}}},
      {"scenes", SceneList{{"amtec_arm", "cart"}, {"pick_and_place"}}},
      {"set_module_parameter", SetModuleParameter{"motion", "Arm/Ramp", "Mode", "fast"}},
  };
}

}  // namespace visum::testing
