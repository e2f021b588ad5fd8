// The places of the HTTP port: whoever asks is answered, however many others hold a connection.
#include <gmock/gmock.h>

#include "tests/protocol/fixture.h"

namespace visum::protocol {
namespace {

using std::chrono::milliseconds;
using ::testing::HasSubstr;
using testing::RawClient;

struct Health : WebPages {
  WebReply get(const WebRequest&) override { return {200, "text/plain", "ok\n"}; }
};

class HttpLimited : public testing::ServerTest {
 protected:
  HttpLimited() {
    options.web.pages = &pages_;
    options.limits.accepts_per_second = 1e6;
    options.limits.max_http_connections = 8;
  }
  std::unique_ptr<RawClient> connect(const std::string& from = "127.0.0.1") {
    return std::make_unique<RawClient>(server().http_port(), RawClient::Options{.from = from});
  }
  std::string request() {
    return "GET /healthz HTTP/1.1\r\nHost: localhost:" + std::to_string(server().http_port()) + "\r\n\r\n";
  }
  static void say(RawClient& client, const std::string& text) { client.send(std::as_bytes(std::span(text))); }
  // The test fails if no answer comes.
  void ask(RawClient& client) {
    say(client, request());
    std::string answer;
    EXPECT_TRUE(until([&] {
      answer += client.text();
      return answer.ends_with("ok\n");
    })) << answer;
  }
  bool is_closed(RawClient& client) {
    client.text();
    return client.closed();
  }

 private:
  Health pages_;
};

TEST_F(HttpLimited, AnIdleConnectionYieldsItsPlaceToANewerOne) {
  std::vector<std::unique_ptr<RawClient>> idle;
  for (int i = 0; i < 8; ++i) {
    idle.push_back(connect());
    ask(*idle.back());
  }
  const auto other = connect();
  ask(*other);
  EXPECT_TRUE(until([&] { return is_closed(*idle[0]); })) << "the oldest";
  for (int i = 1; i < 8; ++i) ask(*idle[static_cast<std::size_t>(i)]);
  EXPECT_EQ(server().refused(), 0u) << "nobody lost anything";
}

TEST_F(HttpLimited, ConnectionsThatAskForNothingKeepNobodyOut) {
  options.limits.hello_deadline = milliseconds(10'000);
  std::vector<std::unique_ptr<RawClient>> silent;
  for (int i = 0; i < 100; ++i) {
    silent.push_back(connect("127.0.0.2"));
    say(*silent.back(), "GET /");
    if (i % 10 == 0) {
      const auto good = connect("127.0.0.3");
      ask(*good);
    }
  }
}

TEST_F(HttpLimited, TheAddressWithTheMostConnectionsYieldsFirst) {
  options.limits.hello_deadline = milliseconds(10'000);
  const auto slow = connect("127.0.0.3");
  say(*slow, "GET /healthz HTTP/1.1\r\n");
  ask(*connect("127.0.0.4"));  // from here on the one before is accepted
  std::vector<std::unique_ptr<RawClient>> flood;
  for (std::size_t i = 0; i < 40; ++i) {
    flood.push_back(connect("127.0.0.2"));
    ask(*connect("127.0.0.4"));
  }
  say(*slow, "Host: localhost:" + std::to_string(server().http_port()) + "\r\n\r\n");
  std::string answer;
  EXPECT_TRUE(until([&] {
    answer += slow->text();
    return answer.ends_with("ok\n");
  }));
}

// The first request has the time of a Hello; this is one of the further ones.
TEST_F(HttpLimited, AHeadThatDripsInIsCutOff) {
  options.limits.http_head_deadline = milliseconds(100);
  const auto client = connect(), patient = connect();
  ask(*client);
  ask(*patient);
  std::size_t sent = 0;
  const auto head = "GET /healthz HTTP/1.1\r\nX: " + std::string(4000, 'x');
  auto last = std::chrono::steady_clock::now();
  EXPECT_TRUE(until([&] {
    if (const auto now = std::chrono::steady_clock::now();
        now - last > milliseconds(5) && sent < head.size()) {
      last = now;
      say(*client, head.substr(sent++, 1));
    }
    return is_closed(*client);
  }));
  EXPECT_LT(sent, head.size());
  ask(*patient);
}

}  // namespace
}  // namespace visum::protocol
