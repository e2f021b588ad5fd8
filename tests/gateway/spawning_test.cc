// Models that clients bring into a world that runs: what everybody sees of their parts, whose lease counts,
// and what becomes of requests about parts that went.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <semaphore>
#include <string>

#include "protocol/model_bundle.h"
#include "tests/gateway/gateway_rig.h"

namespace visum::gateway {
namespace {

using namespace protocol;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::Field;
using ::testing::HasSubstr;
using ::testing::Not;

class SpawningInTheGateway : public ::testing::Test {
 protected:
  SpawningInTheGateway() {
    rig.tick_side.on_change_ready([this] { ready.release(); });
  }
  ~SpawningInTheGateway() override { rig.tick_side.end_changes(); }

  static SpawnModel cart(const std::string& name) {
    auto model = bundle_of_model(std::filesystem::path(VISUM_SOURCE_DIR) / "models/cart/cart.yaml");
    model.name = name;
    model.pose = {0, 3, 0, 1, 0, 0, 0};
    return model;
  }
  // The reply to a request that the tick's side carries out; nothing but the tick's side acts meanwhile.
  Reply done(NotedSession& session, const Request& request) {
    const auto id = rig.ask(session, request);
    take_changes();
    rig.tell();
    for (const auto& [number, reply] : session.replies)
      if (number == id) return reply;
    ADD_FAILURE() << "no reply";
    return Ok{};
  }
  void take_changes() {
    rig.tick_side.empty_mailbox();
    while (rig.tick_side.waits_for_change()) {
      ASSERT_TRUE(ready.try_acquire_for(std::chrono::seconds(60)));
      rig.tick_side.empty_mailbox();
    }
  }
  std::string refusal(NotedSession& session, const Request& request) {
    const auto reply = done(session, request);
    const auto* error = std::get_if<Error>(&reply);
    return error ? std::string(to_string(error->code)) + ": " + error->text : "done";
  }
  std::vector<std::string> parts(NotedSession& session) {
    std::vector<std::string> names;
    for (const auto& part : rig.answer<PartList>(session, ListParts{}).parts) names.push_back(part.name);
    return names;
  }
  const cycle::BoundPart& part(const std::string& name) {
    for (const auto& bound : std::as_const(rig.simulation).parts())
      if (bound.part->description().name == name) return bound;
    throw std::runtime_error("no part " + name);
  }

  std::counting_semaphore<> ready{0};
  GatewayRig rig{scene::ClockKind::kLockstep};
  NotedSession& admin = rig.connect("admin", Role::kAdmin);
  NotedSession& other = rig.connect("other", Role::kController);
};

TEST_F(SpawningInTheGateway, APartThatComesIsThereForEverybody) {
  const auto before = parts(other);
  const auto reply = done(admin, cart("second"));
  ASSERT_TRUE(std::holds_alternative<ModelSpawned>(reply)) << std::get<Error>(reply).text;
  EXPECT_EQ(std::get<ModelSpawned>(reply).name, "second");
  EXPECT_THAT(std::get<ModelSpawned>(reply).bodies, Contains("second/chassis"));
  EXPECT_THAT(std::get<ModelSpawned>(reply).parts, ElementsAre("second"));
  EXPECT_THAT(other.events, Contains(Field(&Event::kind, "world_changed")));
  EXPECT_THAT(parts(other), Contains("second"));
  EXPECT_EQ(parts(other).size(), before.size() + 1);
  rig.answer<LeaseGrant>(other, AcquireLease{"second"});
  const auto ports = rig.answer<PartDescriptionReply>(other, DescribePart{"second"}).description;
  ASSERT_FALSE(ports.controller_inputs.empty());
  const double value = 0.25 * ports.controller_inputs[0].maximum;
  rig.answer<Ok>(other, Write{"second", 0, {value}, 0});
  rig.tick();
  rig.tell();
  EXPECT_EQ(part("second").controller_inputs[0], value);
  EXPECT_EQ(rig.answer<PartSample>(other, Read{"second"}).controller_inputs[0], value);
  EXPECT_THAT(rig.answer<ModelList>(other, ListModels{}).spawned, ElementsAre("second"));
}

TEST_F(SpawningInTheGateway, AModelWhosePartAnotherHasLeasedStays) {
  done(admin, cart("second"));
  rig.answer<LeaseGrant>(other, AcquireLease{"second"});
  rig.tick();
  EXPECT_THAT(refusal(admin, RemoveModel{"second"}), HasSubstr("leased by 'other'"));
  rig.answer<Ok>(other, ReleaseLease{"second"});
  EXPECT_EQ(refusal(admin, RemoveModel{"second"}), "done");
  EXPECT_THAT(parts(other), Not(Contains("second")));
}

TEST_F(SpawningInTheGateway, TheLeaseAndTheSubscriptionsOfAPartEndWithIt) {
  done(admin, cart("second"));
  rig.answer<LeaseGrant>(admin, AcquireLease{"second"});
  rig.answer<Ok>(other, Subscribe{"second", 1});
  rig.tick();
  EXPECT_EQ(refusal(admin, RemoveModel{"second"}), "done");
  EXPECT_THAT(other.events, Contains(Field(&Event::kind, "lease_lost")));
  const auto lost = std::ranges::find(other.events, "lease_lost", &Event::kind);
  EXPECT_EQ(lost->part, "second");
  EXPECT_THAT(refusal(other, Unsubscribe{"second"}), HasSubstr("no part 'second'"));
  rig.tick();
  rig.tell();
}

TEST_F(SpawningInTheGateway, WhatWasOnItsWayToAPartThatWentReachesNoOther) {
  done(admin, cart("second"));
  rig.answer<LeaseGrant>(admin, AcquireLease{"second"});
  const auto maximum = part("second").part->description().controller_inputs[0].maximum;
  rig.tick();
  rig.ask(admin, RemoveModel{"second"});
  take_changes();  // the sessions' side does not know of it yet
  auto& late = rig.connect("late", Role::kAdmin);
  rig.ask(late, PushBody{"box", {1, 0, 0}, {}, {}, 1'000'000});
  rig.ask(late, AcquireLease{"second", 0, true});
  rig.ask(late, Write{"second", 0, {0.5 * maximum}, 0});
  rig.ask(late, SetParameter{"second", "Emergency Stop", true});
  rig.tell();
  EXPECT_EQ(done(admin, cart("third")).index(), Reply(ModelSpawned{}).index());
  rig.tick();
  rig.tell();
  const auto& inputs = part("third").part->description().controller_inputs;
  EXPECT_EQ(part("third").controller_inputs[0], inputs[0].initial);
  EXPECT_THAT(rig.answer<PartDescriptionReply>(other, DescribePart{"third"}).lease_owner, "");
}

TEST_F(SpawningInTheGateway, ModelsComeAndGoManyTimes) {
  for (int i = 0; i < 20; ++i) {
    EXPECT_EQ(done(admin, cart("second")).index(), Reply(ModelSpawned{}).index());
    rig.answer<LeaseGrant>(admin, AcquireLease{"second"});
    const auto value = 0.5 * part("second").part->description().controller_inputs[0].maximum;
    rig.answer<Ok>(admin, Write{"second", 0, {value}, 0});
    rig.tick();
    EXPECT_EQ(part("second").controller_inputs[0], value);
    EXPECT_EQ(refusal(admin, RemoveModel{"second"}), "done");
  }
  EXPECT_LT(rig.tick_side.part_table()->slots.size(), 2 + rig.simulation.parts().size())
      << "the numbers of parts that went are given again";
}

TEST_F(SpawningInTheGateway, WrongRequestsAreRefusedAndChangeNothing) {
  const auto hash = rig.simulation.state_hash();
  auto wrong = cart("second");
  wrong.files[0].path = "../" + wrong.files[0].path;
  EXPECT_THAT(refusal(admin, wrong), HasSubstr("must be relative"));
  wrong = cart("second");
  wrong.file = "nothing.yaml";
  EXPECT_THAT(refusal(admin, wrong), HasSubstr("not among the files"));
  wrong = cart("second");
  wrong.files.resize(kMostSentFiles + 1, {"a", "b"});
  EXPECT_THAT(refusal(admin, wrong), HasSubstr("at most 256 files"));
  wrong = cart("second");
  wrong.files.push_back({"large.bin", std::string(kMostSentBytes, 'x')});
  EXPECT_THAT(refusal(admin, wrong), HasSubstr("at most 8388608 bytes"));
  wrong = cart("second");
  wrong.pose = {0, 0, 0, 1, 1, 0, 0};
  EXPECT_THAT(refusal(admin, wrong), HasSubstr("unit length"));
  wrong = cart("second");
  wrong.files.clear();
  EXPECT_THAT(refusal(admin, wrong), HasSubstr("unknown name"));
  wrong = cart("no/name");
  EXPECT_THAT(refusal(admin, wrong), HasSubstr("bad value"));
  wrong = cart("second");
  std::erase_if(wrong.files, [](const ModelFile& file) { return file.path.ends_with(".urdf"); });
  EXPECT_THAT(refusal(admin, wrong), HasSubstr("cart.urdf"));
  EXPECT_THAT(refusal(other, cart("second")), HasSubstr("needs the role admin"));
  EXPECT_EQ(rig.simulation.state_hash(), hash);
  EXPECT_THAT(parts(other), Not(Contains("second")));
}

}  // namespace
}  // namespace visum::gateway
