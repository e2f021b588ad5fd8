// TLS without sockets: two streams that are fed with each other's bytes.
#include "protocol/tls.h"

#include <gmock/gmock.h>

#include <filesystem>

#include "tests/protocol/certificates.h"

namespace visum::protocol {
namespace {

using testing::Certificates;
using ::testing::HasSubstr;
using Bytes = std::span<const std::byte>;

// Carries bytes between the two streams until neither has more to send. Returns the plain texts that they
// read.
struct TlsPair {
  TlsPair(TlsStream& the_client, TlsStream& the_server) : client(the_client), server(the_server) {}

  void run() {
    client.write({});
    for (bool any = true; any;) {
      any = carry(client, server, at_server);
      any = carry(server, client, at_client) || any;
    }
  }
  static bool carry(TlsStream& from, TlsStream& to, std::string& read) {
    const Bytes bytes = from.pending();
    to.feed(bytes);
    from.sent(bytes.size());
    std::byte text[7];  // smaller than a record
    while (const std::size_t got = to.read(text)) read.append(reinterpret_cast<const char*>(text), got);
    return !bytes.empty();
  }

  TlsStream& client;
  TlsStream& server;
  std::string at_client, at_server;
};

struct Pair {
  Pair(const TlsFiles& of_client, const TlsFiles& of_server, const std::string& host = "127.0.0.1")
      : client_context(of_client, TlsContext::Side::kClient),
        server_context(of_server, TlsContext::Side::kServer),
        client(client_context, host),
        server(server_context) {
    talk.run();
  }
  TlsContext client_context, server_context;
  TlsStream client, server;
  TlsPair talk{client, server};
};

class Tls : public ::testing::Test {
 protected:
  Certificates certificates_;
};

TEST_F(Tls, BothKnowEachOtherAndWhatOneWritesTheOtherReads) {
  Pair pair(certificates_.files("robot"), certificates_.files("server"));
  EXPECT_TRUE(pair.client.established() && pair.server.established());
  EXPECT_EQ(pair.server.peer_name(), "robot");
  EXPECT_EQ(pair.client.peer_name(), "server");
  const std::string text(100'000, 'x');
  for (Bytes left = std::as_bytes(std::span(text)); !left.empty();)
    left = left.subspan(pair.client.write(left));
  pair.server.write(std::as_bytes(std::span("answer", 6)));
  pair.talk.run();
  EXPECT_EQ(pair.talk.at_server, text);
  EXPECT_EQ(pair.talk.at_client, "answer");
  pair.client.finish();
  pair.talk.run();
  EXPECT_TRUE(pair.server.ended());
  EXPECT_EQ(pair.server.failure(), "");
}

TEST_F(Tls, ACertificateThatHasExpiredIsRefusedByName) {
  Pair pair(certificates_.files("robot", Certificates::kExpired), certificates_.files("server"));
  EXPECT_FALSE(pair.server.established());
  EXPECT_EQ(pair.server.failure(), "the client's certificate is not accepted: certificate has expired");
  EXPECT_EQ(pair.client.failure(), "the server ends it: our certificate has expired");
}

TEST_F(Tls, ACertificateOfAnotherAuthorityIsRefused) {
  const Certificates others;
  TlsFiles stranger = others.files("robot");
  stranger.authority = certificates_.files("robot").authority;
  Pair pair(stranger, certificates_.files("server"));
  EXPECT_FALSE(pair.server.established());
  EXPECT_THAT(pair.server.failure(), HasSubstr("the client's certificate is not accepted: "));
  EXPECT_THAT(pair.client.failure(), HasSubstr("the server ends it: "));
}

TEST_F(Tls, AServerOfAnotherAuthorityIsRefusedByTheClient) {
  const Certificates others;
  Pair pair(others.files("robot"), certificates_.files("server"));
  EXPECT_FALSE(pair.client.established());
  EXPECT_THAT(pair.client.failure(), HasSubstr("the server's certificate is not accepted: "));
}

TEST_F(Tls, AServerUnderAnotherNameIsRefused) {
  Pair other(certificates_.files("robot"), certificates_.files("server"), "10.0.0.1");
  EXPECT_EQ(other.client.failure(), "the server's certificate is not accepted: IP address mismatch");
  Pair named(certificates_.files("robot"), certificates_.files("server"), "elsewhere");
  EXPECT_EQ(named.client.failure(), "the server's certificate is not accepted: hostname mismatch");
  Pair right(certificates_.files("robot"), certificates_.files("server"), "localhost");
  EXPECT_TRUE(right.client.established());
}

TEST_F(Tls, NoiseFailsWithoutHarm) {
  const TlsContext context(certificates_.files("server"), TlsContext::Side::kServer);
  for (int seed = 0; seed < 200; ++seed) {
    TlsStream stream(context);
    std::vector<std::byte> noise{std::byte{0x16}, std::byte{0x03}, std::byte{0x01}};
    unsigned state = static_cast<unsigned>(seed) * 2654435761u + 1u;
    for (int i = 0; i < 300; ++i) {
      state = state * 1664525u + 1013904223u;
      noise.push_back(static_cast<std::byte>(state >> 24));
    }
    stream.feed(noise);
    std::byte text[64];
    EXPECT_EQ(stream.read(text), 0u);
    EXPECT_FALSE(stream.established());
  }
}

TEST_F(Tls, FilesThatAreWrongAreNamed) {
  const auto error = [](const TlsFiles& files) -> std::string {
    try {
      TlsContext(files, TlsContext::Side::kServer);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "nothing was wrong";
  };
  const TlsFiles good = certificates_.files("server");
  EXPECT_EQ(error(good), "nothing was wrong");
  EXPECT_THAT(error({good.authority, good.certificate, ""}), HasSubstr("TLS needs three files"));
  EXPECT_THAT(error({"/nowhere.pem", good.certificate, good.key}),
              HasSubstr("/nowhere.pem: holds no certificate"));
  EXPECT_THAT(error({good.authority, good.key, good.key}), HasSubstr(good.key + ": holds no certificate"));
  EXPECT_THAT(error({good.authority, good.certificate, good.certificate}), HasSubstr("others may read"));
  EXPECT_THAT(
      error({good.authority, good.certificate, certificates_.files("robot").key}),
      HasSubstr("no private key of the certificate in " + good.certificate + ": key values mismatch"));
  std::filesystem::permissions(good.key, std::filesystem::perms::others_read,
                               std::filesystem::perm_options::add);
  EXPECT_THAT(error(good), HasSubstr("others may read the private key"));
}

}  // namespace
}  // namespace visum::protocol
