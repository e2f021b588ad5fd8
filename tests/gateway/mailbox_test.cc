#include "server/gateway/mailbox.h"

#include <gtest/gtest.h>

#include <thread>

namespace visum::gateway {
namespace {

TEST(Mailbox, KeepsTheOrderOfArrival) {
  Mailbox mailbox(4);
  for (std::uint32_t i = 0; i < 3; ++i) {
    auto* input = mailbox.blank_input();
    input->first_port = i;
    mailbox.send(input);
  }
  std::uint64_t last = 0;
  Mailbox::Item item;
  for (std::uint32_t i = 0; i < 3; ++i) {
    ASSERT_TRUE(mailbox.next(item));
    EXPECT_EQ(item.input->first_port, i);
    EXPECT_GT(item.input->arrival, last);
    last = item.input->arrival;
    mailbox.give_back(item.input);
  }
  EXPECT_FALSE(mailbox.next(item));
}

TEST(Mailbox, IsFullRatherThanGrowing_ButKeepsRoomForWhatIsUrgent) {
  Mailbox mailbox(1);
  std::size_t sent = 0;
  while (auto* input = mailbox.blank_input()) {
    mailbox.send(input);
    ++sent;
  }
  EXPECT_EQ(sent, Mailbox::kInputs - Mailbox::kUrgent);
  EXPECT_NE(mailbox.blank_input(true), nullptr);
}

TEST(Mailbox, BringsCommandsBackAndTakesNoMoreThanItHolds) {
  Mailbox mailbox(1);
  for (std::size_t i = 0; i < Mailbox::kCommands; ++i) {
    auto command = std::make_unique<Command>();
    command->id = i;
    EXPECT_TRUE(mailbox.send(std::move(command)));
  }
  EXPECT_FALSE(mailbox.send(std::make_unique<Command>()));
  Mailbox::Item item;
  ASSERT_TRUE(mailbox.next(item));
  item.command->reply = protocol::Ok{};
  mailbox.give_back(std::unique_ptr<Command>(item.command));
  auto done = mailbox.next_done();
  ASSERT_NE(done, nullptr);
  EXPECT_EQ(done->id, 0u);
  EXPECT_TRUE(mailbox.send(std::make_unique<Command>())) << "one came back, one may go";
}

TEST(Mailbox, CarriesEverythingBetweenTwoThreads) {
  Mailbox mailbox(8);
  constexpr std::uint32_t kMany = 100'000;
  std::thread tick_side([&] {
    Mailbox::Item item;
    for (std::uint32_t i = 0; i < kMany;) {
      if (!mailbox.next(item)) {
        mailbox.wait_for(std::chrono::milliseconds(100));
        continue;
      }
      ASSERT_EQ(item.input->values.at(3), i);
      mailbox.give_back(item.input);
      ++i;
    }
  });
  for (std::uint32_t i = 0; i < kMany;) {
    auto* input = mailbox.blank_input();
    if (!input) {
      std::this_thread::yield();
      continue;
    }
    input->values.assign(8, i);
    mailbox.send(input);
    ++i;
  }
  tick_side.join();
}

}  // namespace
}  // namespace visum::gateway
