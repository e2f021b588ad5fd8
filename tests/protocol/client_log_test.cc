#include "protocol/client_log.h"

#include <gtest/gtest.h>
#include <spdlog/spdlog.h>

#include <deque>

namespace visum::protocol {
namespace {

using std::chrono::milliseconds;

TEST(LineLimit, LetsAFewLinesThroughAtOnceAndCountsTheRest) {
  const LineLimit::Time start{};
  LineLimit limit(start);
  int written = 0;
  for (int i = 0; i < 1000; ++i) written += limit.allows(start);
  EXPECT_EQ(written, 9);
  EXPECT_EQ(limit.take_left_out(start + milliseconds(999)), 0u) << "it tells once a second";
  EXPECT_EQ(limit.take_left_out(start + milliseconds(1000)), 991u);
  EXPECT_EQ(limit.take_left_out(start + milliseconds(3000)), 0u);
}

// 37,000 lines a second for ten seconds, and a look at every window of one second.
TEST(LineLimit, NoSecondHasMoreThan20Lines) {
  LineLimit::Time now{};
  LineLimit limit(now);
  std::deque<LineLimit::Time> written;
  std::uint64_t lines = 0, left_out = 0, most = 0;
  for (int i = 0; i < 370'000; ++i, now += std::chrono::nanoseconds(27'027)) {
    const auto told = limit.take_left_out(now);
    left_out += told;
    if (told > 0) written.push_back(now);
    if (limit.allows(now)) {
      written.push_back(now);
      ++lines;
    }
    while (!written.empty() && now - written.front() >= std::chrono::seconds(1)) written.pop_front();
    most = std::max<std::uint64_t>(most, written.size());
  }
  EXPECT_LE(most, LineLimit::kLinesPerSecond);
  EXPECT_EQ(lines + left_out + limit.take_rest(), 370'000u) << "each line is written or counted";
}

TEST(LineLimit, AQuietClientIsNeverCut) {
  LineLimit::Time now{};
  LineLimit limit(now);
  for (int i = 0; i < 1000; ++i, now += milliseconds(120)) EXPECT_TRUE(limit.allows(now));
  EXPECT_EQ(limit.take_rest(), 0u);
}

TEST(AddressLogs, AFloodOfAddressesTakesNoFurtherMemory) {
  const auto log_of_others = spdlog::default_logger();
  spdlog::set_default_logger(std::make_shared<spdlog::logger>("nowhere"));
  AddressLogs logs;
  for (int i = 0; i < 300; ++i) {
    ClientLog& log = logs.of("192.0.2." + std::to_string(i) + ":1");
    for (int line = 0; line < 20; ++line) log.write(LogLevel::kError, "refused");
  }
  EXPECT_EQ(&logs.of("198.51.100.1:1"), &logs.of("198.51.100.2:1")) << "they share one limit";
  EXPECT_EQ(&logs.of("192.0.2.1:1"), &logs.of("192.0.2.1:2"));
  EXPECT_NE(&logs.of("192.0.2.1:1"), &logs.of("192.0.2.2:1"));
  spdlog::set_default_logger(log_of_others);
}

}  // namespace
}  // namespace visum::protocol
