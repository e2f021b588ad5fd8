// The rules of who may ask for which file: DNS names that were made to point here, pages of other origins,
// and malformed requests.
#include "protocol/http_rules.h"

#include <gtest/gtest.h>

namespace visum::protocol {
namespace {

// A request for the page as a browser on this machine sends it.
HttpHead plain_get() {
  HttpHead head;
  head.method = "GET";
  head.target = "/";
  head.hosts = {"localhost:8080"};
  head.local_address = "127.0.0.1";
  return head;
}

HttpHead session_handshake() {
  HttpHead head = plain_get();
  head.target = std::string(kWebSocketPath);
  head.origins = {"http://localhost:8080"};
  head.wants_upgrade = head.is_websocket = true;
  head.subprotocols = {std::string(kWebSocketProtocol)};
  return head;
}

int status_of(const HttpHead& head, std::uint16_t port = 8080, std::vector<std::string> hosts = {}) {
  const auto verdict = HttpRules(port, std::move(hosts)).judge(head);
  EXPECT_EQ(verdict.reason.empty(), verdict.status <= 200);
  return verdict.status;
}

int status_for_host(const std::string& host, const std::string& local_address = "127.0.0.1",
                    std::uint16_t port = 8080, std::vector<std::string> hosts = {}) {
  HttpHead head = plain_get();
  head.hosts = {host};
  head.local_address = local_address;
  return status_of(head, port, std::move(hosts));
}

TEST(HttpRules, ThisMachineIsKnownByItsLoopbackNames) {
  for (const char* host : {"localhost:8080", "127.0.0.1:8080", "[::1]:8080"})
    EXPECT_EQ(status_for_host(host), 200) << host;
}

TEST(HttpRules, TheAddressThatAConnectionCameToIsAName) {
  EXPECT_EQ(status_for_host("192.0.2.7:8080", "192.0.2.7"), 200);
  EXPECT_EQ(status_for_host("[2001:db8::7]:8080", "2001:db8::7"), 200);
  EXPECT_EQ(status_for_host("192.0.2.8:8080", "192.0.2.7"), 421);
}

TEST(HttpRules, NamesThatWereMadeToPointHereAreRefused) {
  for (const char* host : {"evil.example:8080", "localhost.evil.example:8080", "localhost", "localhost:8081",
                           "localhost:8080 ", "localhost:8080.", "localhost:8080:80", "localhost:80", ""})
    EXPECT_EQ(status_for_host(host), 421) << host;
}

TEST(HttpRules, ExactlyOneHostIsNeeded) {
  HttpHead head = plain_get();
  head.hosts = {};
  EXPECT_EQ(status_of(head), 421);
  head.hosts = {"localhost:8080", "localhost:8080"};
  EXPECT_EQ(status_of(head), 421);
}

TEST(HttpRules, FurtherNamesAreKnownWithOurPortOrTheirOwn) {
  const std::vector<std::string> names = {"visum.lab", "proxy.lab:80", "[2001:db8::1]"};
  EXPECT_EQ(status_for_host("visum.lab:8080", "127.0.0.1", 8080, names), 200);
  EXPECT_EQ(status_for_host("proxy.lab:80", "127.0.0.1", 8080, names), 200);
  EXPECT_EQ(status_for_host("[2001:db8::1]:8080", "127.0.0.1", 8080, names), 200);
  EXPECT_EQ(status_for_host("visum.lab", "127.0.0.1", 8080, names), 421);
}

TEST(HttpRules, BrowsersLeavePort80Out) {
  for (const char* host : {"localhost", "localhost:80", "visum.lab", "visum.lab:80", "[2001:db8::1]"})
    EXPECT_EQ(status_for_host(host, "127.0.0.1", 80, {"visum.lab", "[2001:db8::1]"}), 200) << host;
  EXPECT_EQ(status_for_host("visum.lab:8080", "127.0.0.1", 80, {"visum.lab"}), 421);
}

TEST(HttpRules, APort80ThatIsMappedToOursIsLeftOutToo) {
  const std::vector<std::string> names = {"proxy.lab:80"};
  EXPECT_EQ(status_for_host("proxy.lab", "127.0.0.1", 8080, names), 200);
  EXPECT_EQ(status_for_host("proxy.lab:443", "127.0.0.1", 8080, names), 421);
  EXPECT_EQ(status_for_host("proxy.lab:8080", "127.0.0.1", 8080, names), 421);
  HttpHead head = session_handshake();
  head.hosts = {"proxy.lab"};
  head.origins = {"http://proxy.lab"};
  EXPECT_EQ(status_of(head, 8080, names), 101);
  head.origins = {"http://evil.example"};
  EXPECT_EQ(status_of(head, 8080, names), 403);
}

TEST(HttpRules, NamesAreTheSameInCapitals) {
  const std::vector<std::string> names = {"Visum.LAB", "[2001:DB8::1]:8080"};
  for (const char* host : {"visum.lab:8080", "VISUM.lab:8080", "[2001:db8::1]:8080", "LOCALHOST:8080"})
    EXPECT_EQ(status_for_host(host, "127.0.0.1", 8080, names), 200) << host;
  HttpHead head = session_handshake();
  head.hosts = {"Visum.LAB:8080"};
  head.origins = {"http://visum.lab:8080"};
  EXPECT_EQ(status_of(head, 8080, names), 101);
}

TEST(HttpRules, PagesOfOtherOriginsAreRefused) {
  HttpHead head = plain_get();
  head.origins = {"http://localhost:8080"};
  EXPECT_EQ(status_of(head), 200);
  // The same machine under another of its names is another origin.
  for (const char* origin : {"null", "https://localhost:8080", "http://localhost", "http://127.0.0.1:8080",
                             "http://evil.example"}) {
    head.origins = {origin};
    EXPECT_EQ(status_of(head), 403) << origin;
  }
}

TEST(HttpRules, OverTlsTheOriginIsHttpsAndBrowsersLeavePort443Out) {
  const auto status = [](std::uint16_t port, const std::string& host, const std::string& origin) {
    HttpHead head = session_handshake();
    head.hosts = {host};
    head.origins = {origin};
    return HttpRules(port, {"visum.lab", "proxy.lab:443"}, true).judge(head).status;
  };
  EXPECT_EQ(status(8080, "localhost:8080", "https://localhost:8080"), 101);
  EXPECT_EQ(status(8080, "localhost:8080", "http://localhost:8080"), 403);
  EXPECT_EQ(status(8080, "visum.lab:8080", "https://visum.lab:8080"), 101);
  EXPECT_EQ(status(443, "localhost", "https://localhost"), 101);
  EXPECT_EQ(status(443, "visum.lab", "https://visum.lab"), 101);
  EXPECT_EQ(status(8080, "visum.lab", "https://visum.lab"), 421);
  EXPECT_EQ(status(8080, "proxy.lab", "https://proxy.lab"), 101);
  EXPECT_EQ(status(80, "localhost", "https://localhost"), 421);
}

TEST(HttpRules, OnlyReadingMethodsAreServed) {
  HttpHead head = plain_get();
  head.method = "HEAD";
  EXPECT_EQ(status_of(head), 200);
  for (const char* method : {"POST", "PUT", "DELETE", "OPTIONS", "CONNECT", "TRACE", "get"}) {
    head.method = method;
    EXPECT_EQ(status_of(head), 405) << method;
  }
}

TEST(HttpRules, BodiesAreRefused) {
  HttpHead head = plain_get();
  head.has_body = true;
  EXPECT_EQ(status_of(head), 413);
}

TEST(HttpRules, WhatIsNoPlainPathIsRefused) {
  HttpHead head = plain_get();
  for (const char* target : {"", "index.html", "http://localhost:8080/", "*", "/../etc/passwd",
                             "//evil.example", "/a\\b", "/a b", "/a#b", "/a\x7f"}) {
    head.target = target;
    EXPECT_EQ(status_of(head), 400) << target;
  }
}

TEST(HttpRules, APathEndsAtItsQuery) {
  EXPECT_EQ(path_of("/assets/a.js?v=../1"), "/assets/a.js");
  EXPECT_EQ(path_of("/?"), "/");
}

TEST(HttpRules, ASessionIsACompleteHandshake) {
  EXPECT_EQ(status_of(session_handshake()), 101);
  HttpHead head = session_handshake();
  head.is_websocket = false;
  EXPECT_EQ(status_of(head), 426);
  head = session_handshake();
  head.method = "POST";
  EXPECT_EQ(status_of(head), 426);
  head = session_handshake();
  head.subprotocols = {"visum.v2"};
  EXPECT_EQ(status_of(head), 400);
}

// A browser always sends an Origin. Programs use the TCP port instead.
TEST(HttpRules, ASessionNeedsAnOrigin) {
  HttpHead head = session_handshake();
  head.origins = {};
  EXPECT_EQ(status_of(head), 403);
}

TEST(HttpRules, NothingElseIsUpgraded) {
  HttpHead head = session_handshake();
  head.target = "/";
  EXPECT_EQ(status_of(head), 400);
}

}  // namespace
}  // namespace visum::protocol
