// A client that reads slowly, or not at all, loses whole frames and lines: none that it gets is cut.
#include <sys/socket.h>

#include <chrono>
#include <filesystem>
#include <map>
#include <string>
#include <thread>

#include "server/bus/bus_thread.h"
#include "server/bus/channel.h"
#include "tests/bus/bus_line.h"
#include "tests/support/temp_files.h"

namespace visum::bus {
namespace {

using powercube::BusFraming;
using powercube::Telegram;
using namespace std::chrono_literals;

// The answer number `n`: its last bytes count.
Telegram answer(std::uint32_t n) {
  Telegram telegram{Telegram::Kind::kAnswer, 3, {0x0A, 0x3C}};
  for (int shift = 0; shift < 32; shift += 8) telegram.message.put(static_cast<std::uint8_t>(n >> shift));
  return telegram;
}

// Takes the whole frames out of a stream, and notes what is not one of the answers that were sent.
class Reader {
 public:
  Reader(char end, std::string (*encode)(const Telegram&)) : end_(end), encode_(encode) {}
  void take(const std::string& bytes) {
    rest_ += bytes;
    for (auto at = rest_.find(end_); at != std::string::npos; at = rest_.find(end_)) {
      const auto line = rest_.substr(0, at + 1);
      rest_.erase(0, at + 1);
      while (encode_(answer(next_)) != line && next_ < last_) ++next_;
      ASSERT_LT(next_, last_) << "cut: '" << line << "'";
      ++next_, ++whole_;
    }
  }
  void expect_until(std::uint32_t last) { last_ = last; }
  std::uint32_t whole() const { return whole_; }
  const std::string& rest() const { return rest_; }

 private:
  char end_;
  std::string (*encode_)(const Telegram&);
  std::string rest_;
  std::uint32_t next_ = 0, last_ = 0, whole_ = 0;
};

constexpr std::uint32_t kAnswers = 400'000;  // far more than the kernel's buffers hold

// Sends answers from this thread, as the tick does, to a client that reads now and then.
void send_to(BusThread& bus, BusLine& client, std::uint64_t channel, BusFraming framing, Reader& reader) {
  reader.expect_until(kAnswers);
  for (std::uint32_t n = 0; n < kAnswers; ++n) {
    bus.answer({0, channel, framing, answer(n), false});
    bus.send_now();
    if (n % 97 == 0) reader.take(client.read_once(0));
    if (::testing::Test::HasFatalFailure()) return;
  }
  EXPECT_GT(bus.dropped(), 0u) << "the reader was slow enough";
  for (auto bytes = client.read_once(500); !bytes.empty(); bytes = client.read_once(500)) reader.take(bytes);
  EXPECT_EQ(reader.rest(), "") << "the rest of the last line comes without another write";
  EXPECT_EQ(reader.whole() + bus.dropped(), kAnswers);
}

// The same to an adapter that speaks slcan, once it is open.
void send_frames_to(BusThread& bus, BusLine& client) {
  client.send("O\r");
  ASSERT_EQ(client.read_to('\r'), "\r");
  Reader reader('\r', BusLine::slcan);
  send_to(bus, client, 1, BusFraming::kCan, reader);
}

std::vector<BusThread::Wiring> wired(std::unique_ptr<BusLink> link) {
  std::vector<BusThread::Wiring> wirings;
  wirings.push_back({std::move(link), 0});
  return wirings;
}

TEST(SlowReader, OfSlcanOverTcpGetsWholeLines) {
  auto link = open_tcp("0");
  auto client = BusLine::tcp(link->name());
  const int small = 1 << 16;
  ASSERT_EQ(::setsockopt(client.fd(), SOL_SOCKET, SO_RCVBUF, &small, sizeof small), 0);
  BusThread bus(wired(std::move(link)), [] {});
  send_frames_to(bus, client);
}

TEST(SlowReader, OfSlcanOnATtyGetsWholeLines) {
  const test::TempFiles files;
  const auto path = files.folder() / "arm.can";
  BusThread bus(wired(open_slcan(path.string())), [] {});
  auto client = BusLine::tty(path);
  send_frames_to(bus, client);
}

TEST(SlowReader, OfASerialLineGetsWholeFrames) {
  const test::TempFiles files;
  const auto path = files.folder() / "arm.tty";
  BusThread bus(wired(open_pty(path.string())), [] {});
  auto client = BusLine::tty(path);
  Reader reader('\x03', BusLine::serial);
  send_to(bus, client, 1, BusFraming::kSerial, reader);
}

}  // namespace
}  // namespace visum::bus
