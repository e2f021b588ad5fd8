// Requests that change a world while it runs: their refusals, whose lease counts, what ends with a session,
// and what those who follow events hear.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/gateway/gateway_rig.h"

namespace visum::gateway {
namespace {

using namespace protocol;
using ::testing::Contains;
using ::testing::Field;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* kBall = "{name: ball, mass: 0.5, pose: {xyz: [1.5, 0, 2]}, shapes: [{sphere: 0.1}]}";
constexpr const char* kDoor =
    "{name: door, kinematic: true, pose: {xyz: [3, 0, 2]}, shapes: [{box: [0.1, 1, 1]}]}";

class ChangingWorld : public ::testing::Test {
 protected:
  ChangingWorld() {
    EXPECT_EQ(rig.simulation.add_body(kBall).text(), "");
    EXPECT_EQ(rig.simulation.add_body(kDoor).text(), "");
  }
  // The reply to a request that the tick's side carries out.
  Reply done(NotedSession& session, const Request& request) {
    const auto id = rig.ask(session, request);
    rig.tick_side.empty_mailbox();
    rig.tell();
    for (const auto& [number, reply] : session.replies)
      if (number == id) return reply;
    ADD_FAILURE() << "no reply";
    return Ok{};
  }
  std::string refusal(NotedSession& session, const Request& request) {
    const auto reply = done(session, request);
    const auto* error = std::get_if<Error>(&reply);
    return error ? std::string(to_string(error->code)) + ": " + error->text : "done";
  }
  const world::BodyState& state_of(const std::string& body) {
    return rig.simulation.state().bodies[rig.simulation.model().find_body(body).index()];
  }
  void run(int ticks) {
    for (int i = 0; i < ticks; ++i) rig.tick();
    rig.tell();
  }

  GatewayRig rig{scene::ClockKind::kLockstep};
  NotedSession& admin = rig.connect("admin", Role::kAdmin);
  NotedSession& other = rig.connect("other", Role::kAdmin);
};

TEST_F(ChangingWorld, BodiesAndJointsGoWhereTheyArePut) {
  EXPECT_EQ(refusal(admin, SetBody{"ball", {0.5, 0.5, 3, 1, 0, 0, 0}, {0, 0, 1, 0, 0, 0}}), "done");
  EXPECT_EQ(state_of("ball").p_WC, Eigen::Vector3d(0.5, 0.5, 3));
  EXPECT_EQ(state_of("ball").v_WC, Eigen::Vector3d(0, 0, 1));
  EXPECT_EQ(refusal(admin, SetJoints{"arm", {{"joint_1", 0.75}}}), "done");
  const auto joint = rig.simulation.model().find_joint("arm/joint_1");
  EXPECT_NEAR(rig.simulation.state().joints[joint.index()].position, 0.75, 1e-12);
}

TEST_F(ChangingWorld, RefusalsSayWhatIsWrongAndChangeNothing) {
  const auto before = rig.simulation.state_hash();
  EXPECT_EQ(refusal(admin, SetBody{"bal", {0, 0, 1, 1, 0, 0, 0}}),
            "unknown name: there is no body 'bal'; did you mean 'ball'?");
  EXPECT_THAT(refusal(admin, SetBody{"ball", {0, 0, 1, 0.5, 0, 0, 0}}), HasSubstr("of unit length"));
  EXPECT_THAT(refusal(admin, SetBody{"ball", {0, 0, 1}}), HasSubstr("x y z qw qx qy qz"));
  EXPECT_THAT(refusal(admin, SetBody{"arm/link_3", {0, 0, 1, 1, 0, 0, 0}}), HasSubstr("hangs on the joint"));
  EXPECT_THAT(refusal(admin, SetJoints{"arm", {{"joint_9", 0.0}}}), HasSubstr("there is no joint 'joint_9'"));
  EXPECT_THAT(refusal(admin, SetJoints{"leg", {{"joint_1", 0.0}}}), HasSubstr("no model 'leg'"));
  EXPECT_THAT(refusal(admin, SetJoints{"arm", {{"joint_1", 77.0}}}),
              HasSubstr("bad value: joint 'arm/joint_1'"));
  EXPECT_THAT(refusal(admin, SetJoints{"arm", {}}), HasSubstr("1 to 1000 joints"));
  EXPECT_THAT(refusal(admin, PullBody{"ball", {}, {0, 0, 1}, 0.0}), HasSubstr("max_force_n"));
  EXPECT_THAT(refusal(admin, PullBody{"door", {}, {0, 0, 1}, 1.0}), HasSubstr("no force moves it"));
  EXPECT_THAT(refusal(admin, ReleaseBody{"ball"}), HasSubstr("nobody pulls 'ball'"));
  EXPECT_THAT(refusal(admin, TakeSnapshot{"../etc/passwd"}), HasSubstr("begins with a letter"));
  EXPECT_THAT(refusal(admin, TakeSnapshot{"monday"}), HasSubstr("keeps no files"));
  EXPECT_THAT(refusal(admin, StopRecording{}), HasSubstr("keeps no files"));
  EXPECT_EQ(rig.simulation.state_hash(), before);
}

TEST_F(ChangingWorld, JointsOfAPartThatAnotherSessionHasLeasedAreRefused) {
  auto& controller = rig.connect("controller");
  rig.answer<LeaseGrant>(controller, AcquireLease{"arm"});
  EXPECT_EQ(refusal(admin, SetJoints{"arm", {{"joint_1", 0.5}}}),
            "leased: joint 'arm/joint_1' is driven by 'arm', which 'controller' has leased");
  rig.answer<Ok>(controller, ReleaseLease{"arm"});
  EXPECT_EQ(refusal(admin, SetJoints{"arm", {{"joint_1", 0.5}}}), "done");
}

TEST_F(ChangingWorld, APullIsOneSessionsAndEndsWithIt) {
  EXPECT_EQ(refusal(admin, PullBody{"ball", {}, {1.5, 0, 2.5}, 50.0}), "done");
  EXPECT_THAT(refusal(other, PullBody{"ball", {}, {1.5, 0, 1}, 50.0}),
              HasSubstr("pulled by another session"));
  EXPECT_THAT(refusal(other, ReleaseBody{"ball"}), HasSubstr("pulled by another session"));
  EXPECT_EQ(refusal(admin, PullBody{"ball", {}, {1.5, 0, 2.6}, 50.0}), "done") << "it moves its target";
  run(800);
  EXPECT_NEAR(state_of("ball").p_WC.z(), 2.6 - 9.81 / 400, 5e-3) << "where spring and weight are equal";
  rig.leave(admin, CloseReason::kLost);
  run(300);
  EXPECT_TRUE(rig.simulation.pulls().empty());
  EXPECT_LT(state_of("ball").p_WC.z(), 2.3);
}

TEST_F(ChangingWorld, AKinematicBodyStandsStillOnceItsSessionIsGone) {
  EXPECT_EQ(refusal(admin, SetBody{"door", {}, {0, 0, 1, 0, 0, 0}}), "done");
  run(100);
  EXPECT_NEAR(state_of("door").p_WC.z(), 2.1, 1e-9);
  rig.leave(admin, CloseReason::kGoodbye);
  run(100);
  EXPECT_NEAR(state_of("door").p_WC.z(), 2.1, 2e-3);
  EXPECT_TRUE(state_of("door").v_WC.isZero(0.0));
  EXPECT_EQ(refusal(other, SetBody{"door", {}, {0, 0, 1, 0, 0, 0}, true}), "done");
  rig.leave(other, CloseReason::kGoodbye);
  run(100);
  EXPECT_NEAR(state_of("door").p_WC.z(), 2.2, 4e-3) << "unless it keeps moving";
}

TEST_F(ChangingWorld, ResetsOfTimeAndStateAnswerAtOnce) {
  run(50);
  EXPECT_EQ(refusal(admin, Reset{ResetScope::kTime}), "done");
  EXPECT_EQ(rig.simulation.tick_count(), 0);
  EXPECT_THAT(admin.events, Contains(Field(&Event::kind, "era")));
  EXPECT_EQ(refusal(admin, Reset{ResetScope::kState}), "done");
  EXPECT_TRUE(rig.simulation.model().find_body("ball").valid());
}

// ---------------------------------------- events

TEST_F(ChangingWorld, SubscribersHearOfLeasesFaultsAndAnnouncements) {
  auto& observer = rig.connect("observer", Role::kObserver);
  auto& controller = rig.connect("controller");
  rig.answer<EventList>(observer, SubscribeEvents{});
  rig.answer<LeaseGrant>(controller, AcquireLease{"arm"});
  rig.answer<Ok>(controller, Announce{"the box is gripped", "check"});
  rig.answer<Ok>(admin, InjectFault{"arm", "part_silent", {}, 0});
  rig.answer<Ok>(controller, ReleaseLease{"arm"});
  std::vector<std::string> kinds;
  for (const auto& event : observer.events) kinds.push_back(event.kind);
  EXPECT_EQ(kinds, (std::vector<std::string>{"lease_granted", "check", "fault", "lease_released"}));
  EXPECT_EQ(observer.events[1].source, "controller");
  EXPECT_EQ(observer.events[1].level, EventLevel::kInfo);
  EXPECT_EQ(observer.events[2].level, EventLevel::kWarning);
  EXPECT_THAT(controller.events, Not(Contains(Field(&Event::kind, "check"))))
      << "who did not ask hears nothing";
  rig.answer<Ok>(observer, UnsubscribeEvents{});
  rig.answer<Ok>(controller, Announce{"unheard"});
  EXPECT_EQ(observer.events.size(), 4u);
  const auto past = rig.answer<EventList>(observer, SubscribeEvents{EventLevel::kWarning});
  ASSERT_EQ(past.events.size(), 1u) << "of the kept ones, those of at least that level";
  EXPECT_EQ(past.events[0].kind, "fault");
}

TEST_F(ChangingWorld, AnnouncementsAreBounded) {
  auto& controller = rig.connect("controller");
  EXPECT_THAT(refusal(controller, Announce{""}), HasSubstr("1 to 1000 bytes"));
  EXPECT_THAT(refusal(controller, Announce{std::string(1001, 'a')}), HasSubstr("1 to 1000 bytes"));
  EXPECT_THAT(refusal(controller, Announce{"a", "lease_lost"}), HasSubstr("kind must be line or check"));
  auto& observer = rig.connect("observer", Role::kObserver);
  rig.answer<EventList>(observer, SubscribeEvents{});
  for (int i = 0; i < 1000; ++i) rig.answer<Ok>(controller, Announce{"again and again"});
  EXPECT_GE(observer.events.size(), 90u);
  EXPECT_LE(observer.events.size(), 400u)
      << "a hundred a second, as many at once, on a slow machine some more";
}

TEST(EventFeeds, TellHowManyWereLeftOut) {
  EventFeed feed;
  const auto now = EventFeed::Clock::now();
  int told = 0;
  for (int i = 0; i < 500; ++i) told += feed.has_room(now);
  EXPECT_LE(told, 101);
  EXPECT_EQ(feed.take_lost(now), 0u) << "there is no room to say so";
  EXPECT_FALSE(feed.has_room(now + std::chrono::seconds(1))) << "first it is said";
  EXPECT_EQ(feed.take_lost(now + std::chrono::seconds(2)), 501u - static_cast<unsigned>(told));
  EXPECT_TRUE(feed.has_room(now + std::chrono::seconds(2)));
}

TEST(EventFeeds, KeepTheNewestAndCutLongTexts) {
  EventFeed feed;
  feed.set_world(2'000'000, "visumd");
  for (int i = 0; i < 1500; ++i) {
    Event event{"log", std::string(999, 'a') + "\xC3\xA4", {}, 1, i};
    feed.keep(event);
    EXPECT_EQ(event.text.size(), 999u) << "no half character";
  }
  const auto kept = feed.kept(EventLevel::kDebug);
  ASSERT_EQ(kept.events.size(), EventFeed::kMostKept);
  EXPECT_EQ(kept.events.front().tick, 500);
  EXPECT_EQ(kept.events.back().sim_time_ns, std::int64_t{1499} * 2'000'000);
  EXPECT_EQ(kept.events.back().source, "visumd");
}

}  // namespace
}  // namespace visum::gateway
