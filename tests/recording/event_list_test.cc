// A recording tells its events in words, each at its tick, within bounds.
#include "server/recording/event_list.h"

#include <gtest/gtest.h>

#include "server/recording/player.h"
#include "tests/recording/recorded_world.h"

namespace visum::recording {
namespace {

using protocol::EventLevel;

std::vector<RecordedEvent> events_of(const std::filesystem::path& file) {
  return Player(file, {}).events().events();
}

void expect_event(const RecordedEvent& found, std::uint64_t position, const std::string& kind,
                  const std::string& text, EventLevel level = EventLevel::kInfo) {
  SCOPED_TRACE(kind);
  EXPECT_EQ(found.position, position);
  EXPECT_EQ(found.event.kind, kind);
  EXPECT_EQ(found.event.text, text);
  EXPECT_EQ(found.event.level, level);
}

TEST(RecordedEvents, TellWhatChangedTheWorldAndWhen) {
  RecordedWorld world("amtec_arm.yaml");
  world->write_inputs(0, 0, std::vector{0.1});  // not told: a hand writes all the time
  world.run(10);
  std::string why;
  const auto fault = hwparts::make_fault("encoder_noise", {{"joint", 2}, {"deviation", 1e-3}}, why);
  ASSERT_TRUE(fault) << why;
  ASSERT_TRUE(world->inject({0, *fault, 0}).done());
  world.run(5);
  world->clear_faults(0, {}, {});
  ASSERT_TRUE(world->set_parameter(0, "Emergency Stop", true).done());
  world.run(5);
  world->lose_controller(0);
  ASSERT_TRUE(world->add_body(kBall).done());
  world.run(5);
  world->reset();
  world.run(5);
  const auto events = events_of(world.finish());
  ASSERT_EQ(events.size(), 6u);
  expect_event(events[0], 10, "fault", "encoder_noise 2 0.001", EventLevel::kWarning);
  EXPECT_EQ(events[0].event.part, "arm");
  EXPECT_EQ(events[0].event.sim_time_ns, 10'000'000);
  expect_event(events[1], 15, "fault_cleared", "all");
  expect_event(events[2], 15, "emergency_stop", "Emergency Stop = on", EventLevel::kWarning);
  expect_event(events[3], 20, "lease_lost", "the controller was lost", EventLevel::kWarning);
  expect_event(events[4], 20, "world_changed", "a body came");
  expect_event(events[5], 25, "reset", "back to the beginning: time and state");
}

TEST(RecordedEvents, HoldTheLinesOfTheLogWithoutTheirControls) {
  RecordedWorld world;
  world.run(3);
  world.recorder().log("warning", "a line\x1b[31m");
  world.run(3);
  const auto events = events_of(world.finish());
  ASSERT_EQ(events.size(), 1u);
  // The writer's thread puts lines between ticks when it has both, so the position is not exact
  expect_event(events[0], events[0].position, "log", "a line\\x1b[31m", EventLevel::kWarning);
  EXPECT_LE(events[0].position, 6u);
}

TEST(RecordedEvents, AreBounded) {
  EventList list;
  const std::string text(2 * EventList::kMostBytes, 'x');
  const LogLine line{"info", text};
  for (std::size_t i = 0; i < EventList::kMostEvents + 3; ++i) list.take(RecordingFile::Item{&line}, i);
  EXPECT_EQ(list.events().size(), EventList::kMostEvents);
  EXPECT_EQ(list.left_out(), 3u);
  EXPECT_EQ(list.events()[0].event.text.size(), EventList::kMostBytes);
}

}  // namespace
}  // namespace visum::recording
