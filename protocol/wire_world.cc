// The world and its status, as observers read them.
#include "protocol/wire.h"
#include "protocol/wire_looks.h"
#include "visum.pb.h"

namespace visum::protocol::wire {
namespace {

void put(const ShapeDescription& from, v1::ShapeDescription& to) {
  to.set_kind(from.kind);
  put_numbers(from.size, to.mutable_size());
  put_numbers(from.pose, to.mutable_pose());
  put_numbers(from.color, to.mutable_color());
  to.set_mesh(from.mesh);
  to.set_surface(from.surface);
  to.set_collides(from.collides);
  to.set_material(from.material);
}

void take(const v1::ShapeDescription& from, ShapeDescription& to) {
  to.kind = from.kind();
  take_numbers(from.size(), to.size);
  take_numbers(from.pose(), to.pose);
  take_numbers(from.color(), to.color);
  to.mesh = from.mesh();
  to.surface = from.surface();
  to.collides = from.collides();
  to.material = from.material();
}

void put(const BodyDescription& from, v1::BodyDescription& to) {
  to.set_name(from.name);
  to.set_model(from.model);
  to.set_fixed(from.fixed);
  to.set_mass_kg(from.mass_kg);
  for (const ShapeDescription& shape : from.shapes) put(shape, *to.add_shapes());
  to.set_engine(from.engine);
  put_numbers(from.com, to.mutable_com());
  to.set_kinematic(from.kinematic);
}

void take(const v1::BodyDescription& from, BodyDescription& to) {
  to.name = from.name();
  to.model = from.model();
  to.fixed = from.fixed();
  to.mass_kg = from.mass_kg();
  for (const auto& shape : from.shapes()) take(shape, to.shapes.emplace_back());
  to.engine = from.engine();
  take_numbers(from.com(), to.com);
  to.kinematic = from.kinematic();
}

void put(const JointDescription& from, v1::JointDescription& to) {
  to.set_name(from.name);
  to.set_type(from.type);
  to.set_parent(from.parent);
  to.set_child(from.child);
  to.set_lower(from.lower);
  to.set_upper(from.upper);
  to.set_part(from.part);
  put_numbers(from.pose, to.mutable_pose());
  put_numbers(from.axis, to.mutable_axis());
}

JointDescription joint_of(const v1::JointDescription& from) {
  JointDescription to{
      from.name(), from.type(), from.parent(), from.child(), from.lower(), from.upper(), from.part(), {}, {}};
  take_numbers(from.pose(), to.pose);
  take_numbers(from.axis(), to.axis);
  return to;
}

void put(const ContactSample& from, v1::ContactSample& to) {
  to.set_body_a(from.body_a);
  to.set_body_b(from.body_b);
  put_numbers(from.position, to.mutable_position());
  put_numbers(from.normal, to.mutable_normal());
  to.set_depth(from.depth);
  to.set_normal_force_n(from.normal_force_n);
}

void take(const v1::ContactSample& from, ContactSample& to) {
  to.body_a = from.body_a();
  to.body_b = from.body_b();
  take_numbers(from.position(), to.position);
  take_numbers(from.normal(), to.normal);
  to.depth = from.depth();
  to.normal_force_n = from.normal_force_n();
}

void put(const LockstepMember& from, v1::LockstepMember& to) {
  to.set_client(from.client);
  to.set_granted_tick(from.granted_tick);
  to.set_waiting_ns(from.waiting_ns);
  to.set_grade(from.grade);
  to.set_note(from.note);
}

void put(const PhaseTime& from, v1::PhaseTime& to) {
  to.set_name(from.name);
  to.set_mean_ns(from.mean_ns);
  to.set_max_ns(from.max_ns);
}

void put(const Exchange& from, v1::Exchange& to) {
  to.set_name(from.name);
  to.set_count(from.count);
}

}  // namespace

void put(const ServerStatus& from, v1::ServerStatus& to) {
  to.set_tick(from.tick);
  to.set_sim_time_ns(from.sim_time_ns);
  to.set_era(from.era);
  to.set_paused(from.paused);
  to.set_frozen(from.frozen);
  to.set_frozen_reason(from.frozen_reason);
  to.set_clock(from.clock);
  to.set_speed(from.speed);
  to.set_real_time_factor(from.real_time_factor);
  to.set_overruns(from.overruns);
  to.set_lateness_p50_ns(from.lateness_p50_ns);
  to.set_lateness_p999_ns(from.lateness_p999_ns);
  to.set_lateness_max_ns(from.lateness_max_ns);
  to.set_state_hash(from.state_hash);
  to.set_sessions(from.sessions);
  for (const LockstepMember& member : from.lockstep) put(member, *to.add_lockstep());
  for (const PhaseTime& phase : from.phases) put(phase, *to.add_phases());
  to.set_refused(from.refused);
  to.set_own_allocations(from.own_allocations);
  to.set_stuck_node(from.stuck_node);
  to.set_stuck_ns(from.stuck_ns);
  for (const PartBus& bus : from.buses) {
    auto& w = *to.add_buses();
    w.set_part(bus.part);
    w.set_name(bus.name);
  }
  for (const auto& client : from.free_running) to.add_free_running(client);
  to.set_solver_warnings(from.solver_warnings);
  for (const Exchange& exchange : from.exchanges) put(exchange, *to.add_exchanges());
  for (const Exchange& exchange : from.bus_exchanges) put(exchange, *to.add_bus_exchanges());
  to.set_bus_drops(from.bus_drops);
  to.set_working(from.working);
  to.set_working_ns(from.working_ns);
  to.set_silent_stops(from.silent_stops);
  to.set_late_writes(from.late_writes);
  to.set_limited_ticks(from.limited_ticks);
  for (const auto& body : from.limited_bodies) to.add_limited_bodies(body);
}

void take(const v1::ServerStatus& from, ServerStatus& to) {
  to.tick = from.tick();
  to.sim_time_ns = from.sim_time_ns();
  to.era = from.era();
  to.paused = from.paused();
  to.frozen = from.frozen();
  to.frozen_reason = from.frozen_reason();
  to.clock = from.clock();
  to.speed = from.speed();
  to.real_time_factor = from.real_time_factor();
  to.overruns = from.overruns();
  to.lateness_p50_ns = from.lateness_p50_ns();
  to.lateness_p999_ns = from.lateness_p999_ns();
  to.lateness_max_ns = from.lateness_max_ns();
  to.state_hash = from.state_hash();
  to.sessions = from.sessions();
  for (const auto& w : from.lockstep())
    to.lockstep.push_back({w.client(), w.granted_tick(), w.waiting_ns(), w.grade(), w.note()});
  for (const auto& w : from.phases()) to.phases.push_back({w.name(), w.mean_ns(), w.max_ns()});
  to.refused = from.refused();
  to.own_allocations = from.own_allocations();
  to.stuck_node = from.stuck_node();
  to.stuck_ns = from.stuck_ns();
  for (const auto& w : from.buses()) to.buses.push_back({w.part(), w.name()});
  to.free_running.assign(from.free_running().begin(), from.free_running().end());
  to.solver_warnings = from.solver_warnings();
  for (const auto& w : from.exchanges()) to.exchanges.push_back({w.name(), w.count()});
  for (const auto& w : from.bus_exchanges()) to.bus_exchanges.push_back({w.name(), w.count()});
  to.bus_drops = from.bus_drops();
  to.working = from.working();
  to.working_ns = from.working_ns();
  to.silent_stops = from.silent_stops();
  to.late_writes = from.late_writes();
  to.limited_ticks = from.limited_ticks();
  to.limited_bodies.assign(from.limited_bodies().begin(), from.limited_bodies().end());
}

void put(const WorldDescription& from, v1::WorldDescription& to) {
  to.set_scene(from.scene);
  to.set_tick_ns(from.tick_ns);
  put_numbers(from.gravity, to.mutable_gravity());
  for (const BodyDescription& body : from.bodies) put(body, *to.add_bodies());
  for (const JointDescription& joint : from.joints) put(joint, *to.add_joints());
  to.set_revision(from.revision);
  put_looks(from, to);
}

void take(const v1::WorldDescription& from, WorldDescription& to) {
  to.scene = from.scene();
  to.tick_ns = from.tick_ns();
  take_numbers(from.gravity(), to.gravity);
  for (const auto& body : from.bodies()) take(body, to.bodies.emplace_back());
  for (const auto& joint : from.joints()) to.joints.push_back(joint_of(joint));
  to.revision = from.revision();
  take_looks(from, to);
}

void put(const WorldSample& from, v1::WorldSample& to) {
  to.set_tick(from.tick);
  to.set_sim_time_ns(from.sim_time_ns);
  to.set_era(from.era);
  put_numbers(from.poses, to.mutable_poses());
  put_numbers(from.velocities, to.mutable_velocities());
  put_numbers(from.joint_positions, to.mutable_joint_positions());
  put_numbers(from.joint_velocities, to.mutable_joint_velocities());
  put_numbers(from.joint_efforts, to.mutable_joint_efforts());
  put_numbers(from.following_errors, to.mutable_following_errors());
  put_numbers(from.peak_following_errors, to.mutable_peak_following_errors());
  put_numbers(from.peak_contact_forces, to.mutable_peak_contact_forces());
  for (const ContactSample& contact : from.contacts) put(contact, *to.add_contacts());
  to.set_state_hash(from.state_hash);
  to.set_revision(from.revision);
  to.set_conflated(from.conflated);
}

void take(const v1::WorldSample& from, WorldSample& to) {
  to.tick = from.tick();
  to.sim_time_ns = from.sim_time_ns();
  to.era = from.era();
  take_numbers(from.poses(), to.poses);
  take_numbers(from.velocities(), to.velocities);
  take_numbers(from.joint_positions(), to.joint_positions);
  take_numbers(from.joint_velocities(), to.joint_velocities);
  take_numbers(from.joint_efforts(), to.joint_efforts);
  take_numbers(from.following_errors(), to.following_errors);
  take_numbers(from.peak_following_errors(), to.peak_following_errors);
  take_numbers(from.peak_contact_forces(), to.peak_contact_forces);
  for (const auto& contact : from.contacts()) take(contact, to.contacts.emplace_back());
  to.state_hash = from.state_hash();
  to.revision = from.revision();
  to.conflated = from.conflated();
}

void put(const MeshData& from, v1::MeshData& to) {
  put_numbers(from.vertices, to.mutable_vertices());
  put_numbers(from.triangles, to.mutable_triangles());
}

void take(const v1::MeshData& from, MeshData& to) {
  take_numbers(from.vertices(), to.vertices);
  take_numbers(from.triangles(), to.triangles);
}

}  // namespace visum::protocol::wire
