// ClientMessage: one line per request and direction.
#include <variant>

#include "protocol/wire.h"
#include "visum.pb.h"

namespace visum::protocol::wire {
namespace {

void put_gate(const Gate& from, v1::Gate& to) {
  to.set_part(from.part);
  to.set_client(from.client);
  to.set_period_ns(from.period_ns);
  to.set_module(from.module);
  to.set_frame(bytes_of(from.frame));
}

Gate gate_of(const v1::Gate& from) {
  return {from.part(), from.client(), from.period_ns(), from.module(), bytes_of(from.frame())};
}

bool take(const v1::Join& from, Join& to, std::string& why) {
  to.timeout_ns = from.timeout_ns();
  to.grade = from.grade();
  if (from.has_gate()) to.gate = gate_of(from.gate());
  to.parts.assign(from.parts().begin(), from.parts().end());
  return take_enum(from.on_timeout(), OnTimeout::kFree, to.on_timeout, "on_timeout", why);
}

struct PutRequest : PutScenarioRequest {
  using PutScenarioRequest::operator();

  void operator()(const Hello& m) const {
    auto& w = *to.mutable_hello();
    w.set_min_version(m.min_version);
    w.set_max_version(m.max_version);
    w.set_client_name(m.client_name);
    w.set_role(static_cast<v1::Role>(m.role));
    w.set_token(m.token);
  }
  void operator()(const Status&) const { to.mutable_status(); }
  void operator()(const ListParts&) const { to.mutable_list_parts(); }
  void operator()(const DescribePart& m) const { to.mutable_describe_part()->set_part(m.part); }
  void operator()(const AcquireLease& m) const {
    auto& w = *to.mutable_acquire_lease();
    w.set_part(m.part);
    w.set_deadline_ns(m.deadline_ns);
    w.set_take(m.take);
  }
  void operator()(const ReleaseLease& m) const { to.mutable_release_lease()->set_part(m.part); }
  void operator()(const Write& m) const {
    auto& w = *to.mutable_write();
    w.set_part(m.part);
    w.set_first_port(m.first_port);
    put_numbers(m.values, w.mutable_values());
    w.set_sequence(m.sequence);
  }
  void operator()(const Read& m) const { to.mutable_read()->set_part(m.part); }
  void operator()(const Subscribe& m) const {
    to.mutable_subscribe()->set_part(m.part);
    to.mutable_subscribe()->set_every_n_ticks(m.every_n_ticks);
  }
  void operator()(const Unsubscribe& m) const { to.mutable_unsubscribe()->set_part(m.part); }
  void operator()(const GetParameters& m) const { to.mutable_get_parameters()->set_part(m.part); }
  void operator()(const SetParameter& m) const {
    auto& w = *to.mutable_set_parameter();
    w.set_part(m.part);
    w.set_name(m.name);
    wire::put(m.value, *w.mutable_value());
  }
  void operator()(const ReadBlackboard& m) const {
    auto& w = *to.mutable_read_blackboard();
    w.set_part(m.part);
    w.set_name(m.name);
    w.set_offset(m.offset);
    w.set_length(m.length);
  }
  void operator()(const WriteBlackboard& m) const {
    auto& w = *to.mutable_write_blackboard();
    w.set_part(m.part);
    w.set_name(m.name);
    w.set_offset(m.offset);
    w.set_data(bytes_of(m.data));
  }
  void operator()(const Join& m) const {
    auto& w = *to.mutable_join();
    w.set_timeout_ns(m.timeout_ns);
    w.set_grade(m.grade);
    w.set_on_timeout(static_cast<v1::OnTimeout>(m.on_timeout));
    if (m.gate) put_gate(*m.gate, *w.mutable_gate());
    for (const auto& part : m.parts) w.add_parts(part);
  }
  void operator()(const Advance& m) const {
    auto& w = *to.mutable_advance();
    w.set_ticks(m.ticks);
    w.set_follow_buses(m.follow_buses);
    w.set_bus_said(m.bus_said);
    put_streams(m.streams, w.mutable_streams());
    w.set_members(m.members);
    w.set_answer_may_wait(m.answer_may_wait);
  }
  void operator()(const Leave&) const { to.mutable_leave(); }
  void operator()(const Note& m) const { to.mutable_note()->set_text(m.text); }
  void operator()(const DescribeWorld&) const { to.mutable_describe_world(); }
  void operator()(const ReadWorld&) const { to.mutable_read_world(); }
  void operator()(const SubscribeWorld& m) const {
    to.mutable_subscribe_world()->set_every_n_ticks(m.every_n_ticks);
  }
  void operator()(const UnsubscribeWorld&) const { to.mutable_unsubscribe_world(); }
  void operator()(const ReadTexture& m) const { to.mutable_read_texture()->set_texture(m.texture); }
  void operator()(const ReadMesh& m) const { to.mutable_read_mesh()->set_mesh(m.mesh); }
  void operator()(const Pause&) const { to.mutable_pause(); }
  void operator()(const Resume&) const { to.mutable_resume(); }
  void operator()(const Step& m) const { to.mutable_step()->set_ticks(m.ticks); }
  void operator()(const SetSpeed& m) const { to.mutable_set_speed()->set_factor(m.factor); }
  void operator()(const Reset& m) const {
    to.mutable_reset()->set_scope(static_cast<v1::ResetScope>(m.scope));
  }
  void operator()(const SetBody& m) const {
    auto& w = *to.mutable_set_body();
    w.set_body(m.body);
    put_numbers(m.pose, w.mutable_pose());
    put_numbers(m.velocity, w.mutable_velocity());
    w.set_keeps_moving(m.keeps_moving);
  }
  void operator()(const SetJoints& m) const {
    auto& w = *to.mutable_set_joints();
    w.set_model(m.model);
    w.set_keeps_moving(m.keeps_moving);
    for (const auto& joint : m.joints) {
      auto& entry = *w.add_joints();
      entry.set_name(joint.name);
      entry.set_position(joint.position);
      entry.set_velocity(joint.velocity);
    }
  }
  void operator()(const PullBody& m) const {
    auto& w = *to.mutable_pull_body();
    w.set_body(m.body);
    put_numbers(m.point_m, w.mutable_point_m());
    put_numbers(m.target_m, w.mutable_target_m());
    w.set_max_force_n(m.max_force_n);
    w.set_duration_ns(m.duration_ns);
  }
  void operator()(const SubscribeEvents& m) const {
    to.mutable_subscribe_events()->set_level(static_cast<v1::EventLevel>(m.level));
  }
  void operator()(const UnsubscribeEvents&) const { to.mutable_unsubscribe_events(); }
  void operator()(const Announce& m) const {
    auto& w = *to.mutable_announce();
    w.set_text(m.text);
    w.set_kind(m.kind);
    w.set_level(static_cast<v1::EventLevel>(m.level));
  }
  void operator()(const StartRecording& m) const { to.mutable_start_recording()->set_name(m.name); }
  void operator()(const StopRecording&) const { to.mutable_stop_recording(); }
  void operator()(const ReleaseBody& m) const { to.mutable_release_body()->set_body(m.body); }
  void operator()(const TakeSnapshot& m) const { to.mutable_take_snapshot()->set_name(m.name); }
  void operator()(const RestoreSnapshot& m) const {
    to.mutable_restore_snapshot()->set_snapshot(m.snapshot);
    to.mutable_restore_snapshot()->set_name(m.name);
  }
  void operator()(const PushBody& m) const {
    auto& w = *to.mutable_push_body();
    w.set_body(m.body);
    put_numbers(m.force_n, w.mutable_force_n());
    put_numbers(m.torque_nm, w.mutable_torque_nm());
    put_numbers(m.point_m, w.mutable_point_m());
    w.set_duration_ns(m.duration_ns);
  }
  void operator()(const AddBody& m) const { to.mutable_add_body()->set_yaml(m.yaml); }
  void operator()(const RemoveBody& m) const { to.mutable_remove_body()->set_body(m.body); }
  void operator()(const Shutdown&) const { to.mutable_shutdown(); }
  void operator()(const InjectFault& m) const { wire::put(m, *to.mutable_inject_fault()); }
  void operator()(const ClearFault& m) const {
    auto& w = *to.mutable_clear_fault();
    w.set_part(m.part);
    w.set_kind(m.kind);
    w.set_joint(m.joint);
  }
  void operator()(const ListFaults& m) const { to.mutable_list_faults()->set_part(m.part); }
};

bool take(const v1::Hello& from, Hello& to, std::string& why) {
  to.min_version = from.min_version();
  to.max_version = from.max_version();
  to.client_name = from.client_name();
  to.token = from.token();
  return take_enum(from.role(), Role::kAdmin, to.role, "role", why);
}

bool take(const v1::SetParameter& from, SetParameter& to, std::string& why) {
  to.part = from.part();
  to.name = from.name();
  return wire::take(from.value(), to.value, why);
}

void take(const v1::Write& from, Write& to) {
  to.part = from.part();
  to.first_port = from.first_port();
  take_numbers(from.values(), to.values);
  to.sequence = from.sequence();
}

void take(const v1::PushBody& from, PushBody& to) {
  to.body = from.body();
  take_numbers(from.force_n(), to.force_n);
  take_numbers(from.torque_nm(), to.torque_nm);
  take_numbers(from.point_m(), to.point_m);
  to.duration_ns = from.duration_ns();
}

// Requests that name a part: leases, ports, parameters, blackboards. Only a parameter's value can be refused.
bool take_part_request(const v1::ClientMessage& from, Request& to, std::string& why) {
  switch (from.request_case()) {
    case v1::ClientMessage::kDescribePart:
      to = DescribePart{from.describe_part().part()};
      return true;
    case v1::ClientMessage::kAcquireLease: {
      const auto& w = from.acquire_lease();
      to = AcquireLease{w.part(), w.deadline_ns(), w.take()};
      return true;
    }
    case v1::ClientMessage::kReleaseLease:
      to = ReleaseLease{from.release_lease().part()};
      return true;
    case v1::ClientMessage::kWrite:
      take(from.write(), to.emplace<Write>());
      return true;
    case v1::ClientMessage::kRead:
      to.emplace<Read>().part = from.read().part();
      return true;
    case v1::ClientMessage::kSubscribe:
      to = Subscribe{from.subscribe().part(), from.subscribe().every_n_ticks()};
      return true;
    case v1::ClientMessage::kUnsubscribe:
      to = Unsubscribe{from.unsubscribe().part()};
      return true;
    case v1::ClientMessage::kGetParameters:
      to = GetParameters{from.get_parameters().part()};
      return true;
    case v1::ClientMessage::kSetParameter:
      return take(from.set_parameter(), to.emplace<SetParameter>(), why);
    case v1::ClientMessage::kReadBlackboard: {
      const auto& w = from.read_blackboard();
      to = ReadBlackboard{w.part(), w.name(), w.offset(), w.length()};
      return true;
    }
    case v1::ClientMessage::kWriteBlackboard: {
      const auto& w = from.write_blackboard();
      to = WriteBlackboard{w.part(), w.name(), w.offset(), bytes_of(w.data())};
      return true;
    }
    default:
      why = "a request that this version does not have";
      return false;
  }
}

// Requests about where bodies and joints are, and what is kept of it.
bool take_placing_request(const v1::ClientMessage& from, Request& to) {
  switch (from.request_case()) {
    case v1::ClientMessage::kSetBody: {
      auto& set = to.emplace<SetBody>();
      set.body = from.set_body().body();
      take_numbers(from.set_body().pose(), set.pose);
      take_numbers(from.set_body().velocity(), set.velocity);
      set.keeps_moving = from.set_body().keeps_moving();
      return true;
    }
    case v1::ClientMessage::kSetJoints: {
      auto& set = to.emplace<SetJoints>();
      set.model = from.set_joints().model();
      set.keeps_moving = from.set_joints().keeps_moving();
      for (const auto& joint : from.set_joints().joints())
        set.joints.push_back({joint.name(), joint.position(), joint.velocity()});
      return true;
    }
    case v1::ClientMessage::kPullBody: {
      auto& pull = to.emplace<PullBody>();
      pull.body = from.pull_body().body();
      take_numbers(from.pull_body().point_m(), pull.point_m);
      take_numbers(from.pull_body().target_m(), pull.target_m);
      pull.max_force_n = from.pull_body().max_force_n();
      pull.duration_ns = from.pull_body().duration_ns();
      return true;
    }
    case v1::ClientMessage::kUnsubscribeEvents:
      to = UnsubscribeEvents{};
      return true;
    case v1::ClientMessage::kStartRecording:
      to = StartRecording{from.start_recording().name()};
      return true;
    case v1::ClientMessage::kStopRecording:
      to = StopRecording{};
      return true;
    case v1::ClientMessage::kReleaseBody:
      to = ReleaseBody{from.release_body().body()};
      return true;
    default:
      return false;
  }
}

// Requests to the world as a whole.
bool take_world_request(const v1::ClientMessage& from, Request& to) {
  switch (from.request_case()) {
    case v1::ClientMessage::kAdvance:
      to = Advance{from.advance().ticks(),    from.advance().follow_buses(),
                   from.advance().bus_said(), streams_of(from.advance().streams()),
                   from.advance().members(),  from.advance().answer_may_wait()};
      return true;
    case v1::ClientMessage::kLeave:
      to = Leave{};
      return true;
    case v1::ClientMessage::kNote:
      to = Note{from.note().text()};
      return true;
    case v1::ClientMessage::kDescribeWorld:
      to = DescribeWorld{};
      return true;
    case v1::ClientMessage::kReadWorld:
      to = ReadWorld{};
      return true;
    case v1::ClientMessage::kSubscribeWorld:
      to = SubscribeWorld{from.subscribe_world().every_n_ticks()};
      return true;
    case v1::ClientMessage::kUnsubscribeWorld:
      to = UnsubscribeWorld{};
      return true;
    case v1::ClientMessage::kReadTexture:
      to = ReadTexture{from.read_texture().texture()};
      return true;
    case v1::ClientMessage::kReadMesh:
      to = ReadMesh{from.read_mesh().mesh()};
      return true;
    case v1::ClientMessage::kPause:
      to = Pause{};
      return true;
    case v1::ClientMessage::kResume:
      to = Resume{};
      return true;
    case v1::ClientMessage::kStep:
      to = Step{from.step().ticks()};
      return true;
    case v1::ClientMessage::kSetSpeed:
      to = SetSpeed{from.set_speed().factor()};
      return true;
    case v1::ClientMessage::kTakeSnapshot:
      to = TakeSnapshot{from.take_snapshot().name()};
      return true;
    case v1::ClientMessage::kRestoreSnapshot:
      to = RestoreSnapshot{from.restore_snapshot().snapshot(), from.restore_snapshot().name()};
      return true;
    case v1::ClientMessage::kPushBody:
      take(from.push_body(), to.emplace<PushBody>());
      return true;
    case v1::ClientMessage::kAddBody:
      to = AddBody{from.add_body().yaml()};
      return true;
    case v1::ClientMessage::kRemoveBody:
      to = RemoveBody{from.remove_body().body()};
      return true;
    case v1::ClientMessage::kShutdown:
      to = Shutdown{};
      return true;
    case v1::ClientMessage::kInjectFault:
      wire::take(from.inject_fault(), to.emplace<InjectFault>());
      return true;
    case v1::ClientMessage::kClearFault:
      to = ClearFault{from.clear_fault().part(), from.clear_fault().kind(), from.clear_fault().joint()};
      return true;
    case v1::ClientMessage::kListFaults:
      to = ListFaults{from.list_faults().part()};
      return true;
    default:
      return false;
  }
}

}  // namespace

void put(const Request& from, v1::ClientMessage& to) {
  std::visit(PutRequest{{{to}}}, from);
}

bool take(const v1::ClientMessage& from, Request& to, std::string& why) {
  switch (from.request_case()) {
    case v1::ClientMessage::REQUEST_NOT_SET:
      why = "no request that this version knows";
      return false;
    case v1::ClientMessage::kHello:
      return take(from.hello(), to.emplace<Hello>(), why);
    case v1::ClientMessage::kStatus:
      to = Status{};
      return true;
    case v1::ClientMessage::kListParts:
      to = ListParts{};
      return true;
    case v1::ClientMessage::kJoin:
      return take(from.join(), to.emplace<Join>(), why);
    case v1::ClientMessage::kSubscribeEvents:
      return take_enum(from.subscribe_events().level(), EventLevel::kError,
                       to.emplace<SubscribeEvents>().level, "level", why);
    case v1::ClientMessage::kAnnounce: {
      auto& announced = to.emplace<Announce>();
      announced.text = from.announce().text();
      announced.kind = from.announce().kind();
      return take_enum(from.announce().level(), EventLevel::kError, announced.level, "level", why);
    }
    case v1::ClientMessage::kReset:
      return take_enum(from.reset().scope(), ResetScope::kAll, to.emplace<Reset>().scope, "scope", why);
    default:
      if (take_world_request(from, to) || take_placing_request(from, to) || take_model_request(from, to) ||
          take_scenario_request(from, to))
        return true;
      return take_module_request(from, to, why) || (why.empty() && take_part_request(from, to, why));
  }
}

}  // namespace visum::protocol::wire
