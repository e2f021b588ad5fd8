// The table of protocol/SPEC.md, "Roles and requests": each message × role × state of the lease, against the
// gateway itself. A new message needs a row here.
#include <gtest/gtest.h>

#include <array>
#include <optional>
#include <string>

#include "tests/gateway/gateway_rig.h"

namespace visum::gateway {
namespace {

using namespace protocol;

// The right that a message needs of a role.
enum class May {
  kNot,        // FORBIDDEN
  kWithLease,  // NO_LEASE, unless the session itself holds the lease
  kIfFree,     // LEASED, if another session holds the lease
  kYes
};
struct Row {
  Request request;
  May observer, controller, admin;
};

// A row for each alternative of Request, in the order of that list.
std::vector<Row> table() {
  constexpr auto kNot = May::kNot, kWithLease = May::kWithLease, kIfFree = May::kIfFree, kYes = May::kYes;
  const std::string arm = "arm";
  return {{Hello{}, kNot, kNot, kYes},  // a second one; it is malformed even for an admin
          {Status{}, kYes, kYes, kYes},
          {ListParts{}, kYes, kYes, kYes},
          {DescribePart{arm}, kYes, kYes, kYes},
          {AcquireLease{arm}, kNot, kIfFree, kIfFree},
          {ReleaseLease{arm}, kNot, kWithLease, kWithLease},
          {Write{arm, 0, {0.0}}, kNot, kWithLease, kWithLease},
          {Read{arm}, kYes, kYes, kYes},
          {Subscribe{arm, 1}, kYes, kYes, kYes},
          {Unsubscribe{arm}, kYes, kYes, kYes},
          {GetParameters{arm}, kYes, kYes, kYes},
          {SetParameter{arm, "Supply Voltage", 24.0}, kNot, kWithLease, kYes},
          {ReadBlackboard{arm, "nothing"}, kYes, kYes, kYes},
          // The arm has no blackboard to write, and its name is looked up before the lease.
          {WriteBlackboard{arm, "nothing"}, kNot, kYes, kYes},
          {Join{}, kNot, kYes, kYes},
          {Advance{1}, kNot, kYes, kYes},
          {Leave{}, kNot, kYes, kYes},
          {Note{}, kNot, kYes, kYes},
          {DescribeWorld{}, kYes, kYes, kYes},
          {ReadWorld{}, kYes, kYes, kYes},
          {SubscribeWorld{1}, kYes, kYes, kYes},
          {UnsubscribeWorld{}, kYes, kYes, kYes},
          {ReadMesh{}, kYes, kYes, kYes},
          {ReadTexture{}, kYes, kYes, kYes},
          {Pause{}, kNot, kNot, kYes},
          {Resume{}, kNot, kNot, kYes},
          {Step{1}, kNot, kNot, kYes},
          {SetSpeed{1.0}, kNot, kNot, kYes},
          {Reset{}, kNot, kNot, kYes},
          {TakeSnapshot{}, kNot, kNot, kYes},
          {RestoreSnapshot{}, kNot, kNot, kYes},
          {PushBody{}, kNot, kNot, kYes},
          {AddBody{}, kNot, kNot, kYes},
          {RemoveBody{}, kNot, kNot, kYes},
          {Shutdown{}, kNot, kNot, kYes},
          {InjectFault{}, kNot, kNot, kYes},
          {ClearFault{}, kNot, kNot, kYes},
          {ListFaults{arm}, kYes, kYes, kYes},
          {SetBody{}, kNot, kNot, kYes},
          {SetJoints{arm, {{"joint_1", 0.1}}}, kNot, kNot, kIfFree},
          {PullBody{}, kNot, kNot, kYes},
          {ReleaseBody{}, kNot, kNot, kYes},
          {SubscribeEvents{}, kYes, kYes, kYes},
          {UnsubscribeEvents{}, kYes, kYes, kYes},
          {Announce{"hello"}, kNot, kYes, kYes},
          {StartRecording{"run"}, kNot, kNot, kYes},
          {StopRecording{}, kNot, kNot, kYes},
          {AnnounceModules{"motion"}, kNot, kYes, kYes},
          {ReportModules{"motion"}, kNot, kYes, kYes},
          {ListModules{}, kYes, kYes, kYes},
          {OverrideModulePort{"motion"}, kNot, kYes, kYes},
          {LockBlackboard{arm, "nothing"}, kNot, kYes, kYes},
          {UnlockBlackboard{arm, "nothing"}, kNot, kYes, kYes},

          {SpawnModel{}, kNot, kNot, kYes},
          {RemoveModel{}, kNot, kNot, kYes},
          {ListModels{}, kYes, kYes, kYes},
          {ListScenes{}, kYes, kYes, kYes},
          {LoadScene{}, kNot, kNot, kYes},
          {RunScenario{}, kNot, kNot, kYes},
          {StopScenario{}, kNot, kNot, kYes},
          {ReadScenario{}, kYes, kYes, kYes},
          {SetModuleParameter{"motion"}, kNot, kYes, kYes}};
}

enum class LeaseIs { kFree, kOwn, kAnothers };

// The refusal that the table asks for; none: the request gets through, to whatever answer.
std::optional<ErrorCode> wanted(May may, LeaseIs lease) {
  if (may == May::kNot) return ErrorCode::kForbidden;
  if (may == May::kWithLease && lease != LeaseIs::kOwn) return ErrorCode::kNoLease;
  if (may == May::kIfFree && lease == LeaseIs::kAnothers) return ErrorCode::kLeased;
  return {};
}

// The refusal for want of a right that the request gets; none: it gets through.
std::optional<ErrorCode> refusal(GatewayRig& rig, NotedSession& session, const Request& request) {
  const auto id = rig.ask(session, request);
  rig.tick();
  rig.tell();
  for (const auto& [reply_to, reply] : session.replies) {
    const auto* error = reply_to == id ? std::get_if<Error>(&reply) : nullptr;
    if (error && (error->code == ErrorCode::kForbidden || error->code == ErrorCode::kNoLease ||
                  error->code == ErrorCode::kLeased))
      return error->code;
  }
  return {};
}

void check(GatewayRig& rig, const Request& request, Role role, LeaseIs lease, May may) {
  auto& session = rig.connect("asks", role);
  auto& other = rig.connect("other");
  if (lease != LeaseIs::kFree)
    rig.answer<LeaseGrant>(lease == LeaseIs::kOwn ? session : other, AcquireLease{"arm"});
  EXPECT_EQ(refusal(rig, session, request), wanted(may, lease))
      << "message " << request.index() << ", role " << to_string(role) << ", lease "
      << (lease == LeaseIs::kFree  ? "free"
          : lease == LeaseIs::kOwn ? "its own"
                                   : "another's");
  for (auto* gone : {&session, &other}) rig.leave(*gone, CloseReason::kGoodbye);
  rig.tick();
  rig.tell();
}

TEST(Access, EveryMessageWithEveryRoleAndStateOfTheLeaseDoesWhatTheTableSays) {
  const auto rows = table();
  ASSERT_EQ(rows.size(), std::variant_size_v<Request>) << "each message has its row";
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Row& row = rows[i];
    ASSERT_EQ(row.request.index(), i) << "the rows stand in the messages' order";
    GatewayRig rig(scene::ClockKind::kRealtime);
    for (const auto lease : {LeaseIs::kFree, LeaseIs::kOwn, LeaseIs::kAnothers}) {
      if (lease != LeaseIs::kOwn) check(rig, row.request, Role::kObserver, lease, row.observer);
      check(rig, row.request, Role::kController, lease, row.controller);
      check(rig, row.request, Role::kAdmin, lease, row.admin);
    }
  }
}

}  // namespace
}  // namespace visum::gateway
