// Orders to stop parts, as bytes from anywhere: who is obeyed, and that strangers cost nothing.
#include "server/gateway/stop_orders.h"

#include <gtest/gtest.h>

#include "tests/support/temp_files.h"

namespace visum::gateway {
namespace {

using namespace protocol;
using namespace std::chrono_literals;
using Clock = StopOrders::Clock;

constexpr const char* kToken = "looking-only-0001";

class Orders : public ::testing::Test {
 protected:
  StopOrders make(const Tokens& tokens = Tokens(), bool sessions_only = false) {
    return {{"arm", "cart"}, tokens, sessions_only, latch};
  }
  Tokens tokens_of(const std::string& text) {
    const auto file = files.write("tokens", text);
    std::filesystem::permissions(file,
                                 std::filesystem::perms::owner_read | std::filesystem::perms::owner_write);
    return Tokens(file);
  }
  StopChallenge ask(StopOrders& orders, const std::string& peer = "me") {
    return std::get<StopChallenge>(*orders.answer(encode(StopAsk{nonce}), peer, now));
  }
  StopDatagram order(StopOrders& orders, const KeyedHash& cookie, const std::string& part,
                     const std::string& token = {}, const std::string& peer = "me") {
    const auto proof = token.empty() ? KeyedHash{} : stop_proof(token, cookie, part);
    return *orders.answer(encode(StopOrder{nonce, cookie, proof, part}), peer, now);
  }
  std::vector<std::size_t> pressed() {
    std::vector<std::size_t> parts;
    latch.take([&](std::size_t part) { parts.push_back(part); });
    return parts;
  }
  static StopRefusal why(const StopDatagram& answer) {
    const auto* refused = std::get_if<StopRefused>(&answer);
    return refused ? refused->why : StopRefusal{};
  }

  const test::TempFiles files;
  StopLatch latch{2};
  StopNonce nonce{std::byte{1}};
  Clock::time_point now{1'000s};
};

TEST_F(Orders, AreLatchedAndThenTellWhenTheyActed) {
  auto orders = make();
  const auto challenge = ask(orders);
  EXPECT_EQ(challenge.proof, StopProof::kNone);
  EXPECT_TRUE(std::holds_alternative<StopLatched>(order(orders, challenge.cookie, "cart")));
  EXPECT_TRUE(orders.waits());
  EXPECT_TRUE(orders.acted(now).empty());
  EXPECT_EQ(pressed(), std::vector<std::size_t>{1});
  latch.tell(812);
  const auto answers = orders.acted(now);
  ASSERT_EQ(answers.size(), 1u);
  EXPECT_EQ(answers[0].first, "me");
  EXPECT_EQ(std::get<StopActed>(answers[0].second).tick, 812);
  EXPECT_FALSE(orders.waits());
}

TEST_F(Orders, WithoutANameStopAllParts) {
  auto orders = make();
  order(orders, ask(orders).cookie, "");
  EXPECT_EQ(pressed(), (std::vector<std::size_t>{0, 1}));
}

TEST_F(Orders, ThatAreRepeatedPressNothingAgain) {
  auto orders = make();
  const auto cookie = ask(orders).cookie;
  order(orders, cookie, "arm");
  EXPECT_EQ(pressed().size(), 1u);
  EXPECT_TRUE(std::holds_alternative<StopLatched>(order(orders, cookie, "arm")));
  EXPECT_TRUE(pressed().empty());
  latch.tell(3);
  orders.acted(now);
  EXPECT_EQ(std::get<StopActed>(order(orders, cookie, "arm")).tick, 3);
  EXPECT_TRUE(pressed().empty());
}

TEST_F(Orders, NeedTheCookieOfTheirOwnAddressAndOfToday) {
  auto orders = make();
  const auto cookie = ask(orders, "another").cookie;
  EXPECT_EQ(why(order(orders, cookie, "arm")), StopRefusal::kCookie) << "of another address";
  const auto own = ask(orders).cookie;
  now += 2 * StopOrders::kCookieSlice;
  EXPECT_EQ(why(order(orders, own, "arm")), StopRefusal::kCookie) << "too old";
  auto elsewhere = make();
  EXPECT_EQ(why(order(elsewhere, own, "arm")), StopRefusal::kCookie) << "of another server";
  EXPECT_TRUE(pressed().empty());
}

TEST_F(Orders, NeedATokenWhereThereAreTokensOfAnyRole) {
  const auto tokens = tokens_of("admin does-anything-0001\nobserver " + std::string(kToken) + "\n");
  auto orders = make(tokens);
  const auto challenge = ask(orders);
  EXPECT_EQ(challenge.proof, StopProof::kToken);
  EXPECT_EQ(why(order(orders, challenge.cookie, "arm")), StopRefusal::kProof);
  EXPECT_EQ(why(order(orders, challenge.cookie, "arm", "a-guess-of-16-letters")), StopRefusal::kProof);
  EXPECT_TRUE(pressed().empty());
  EXPECT_TRUE(std::holds_alternative<StopLatched>(order(orders, challenge.cookie, "arm", kToken)));
  EXPECT_EQ(pressed().size(), 1u);
}

TEST_F(Orders, NeedASessionWhereOnlyCertificatesAreKnown) {
  const auto names = tokens_of("admin CN=anna\n");
  auto by_name = make(names);
  auto by_authority = make(Tokens(), true);
  for (auto* orders : {&by_name, &by_authority}) {
    const auto challenge = ask(*orders);
    EXPECT_EQ(challenge.proof, StopProof::kSession);
    EXPECT_EQ(why(order(*orders, challenge.cookie, "arm")), StopRefusal::kSession);
  }
  EXPECT_TRUE(pressed().empty());
}

TEST_F(Orders, NameAPartThatIsThere) {
  auto orders = make();
  EXPECT_EQ(why(order(orders, ask(orders).cookie, "amr")), StopRefusal::kPart);
  EXPECT_TRUE(pressed().empty());
}

TEST_F(Orders, ThatAreTooManyStopAllTheSameAndKeepNothing) {
  auto orders = make();
  for (std::size_t i = 0; i < 3 * StopOrders::kMost; ++i) {
    nonce = {std::byte(i), std::byte(i >> 8)};
    const auto answer = order(orders, ask(orders).cookie, "arm");
    EXPECT_EQ(std::holds_alternative<StopLatched>(answer), i < StopOrders::kMost);
    EXPECT_EQ(pressed().size(), 1u);
  }
  now += StopOrders::kPatience + 1s;
  EXPECT_TRUE(orders.acted(now).empty());
  EXPECT_FALSE(orders.waits());
}

TEST_F(Orders, WhatIsNoneGetsNoAnswer) {
  auto orders = make();
  EXPECT_FALSE(orders.answer({}, "me", now));
  for (const StopDatagram& datagram : {StopDatagram(StopChallenge{}), StopDatagram(StopLatched{}),
                                       StopDatagram(StopActed{}), StopDatagram(StopRefused{})})
    EXPECT_FALSE(orders.answer(encode(datagram), "me", now));
}

}  // namespace
}  // namespace visum::gateway
