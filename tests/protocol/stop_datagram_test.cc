// The datagrams of an emergency stop: each is read as it was written, and nothing else is.
#include "protocol/stop_datagram.h"

#include <gtest/gtest.h>
#include <openssl/hmac.h>

#include <random>

namespace visum::protocol {
namespace {

StopNonce nonce() {
  StopNonce nonce;
  for (std::size_t i = 0; i < nonce.size(); ++i) nonce[i] = std::byte(i + 1);
  return nonce;
}

KeyedHash hash(unsigned char with) {
  KeyedHash hash;
  hash.fill(std::byte{with});
  return hash;
}

std::vector<StopDatagram> one_of_each() {
  return {StopAsk{nonce()},
          StopChallenge{nonce(), hash(7), StopProof::kToken},
          StopOrder{nonce(), hash(7), hash(9), "arm"},
          StopLatched{nonce()},
          StopActed{nonce(), 123'456'789'012},
          StopRefused{nonce(), StopRefusal::kPart}};
}

TEST(StopDatagram, IsReadAsItWasWritten) {
  for (const auto& datagram : one_of_each()) {
    const auto bytes = encode(datagram);
    const auto read = decode_stop(bytes);
    ASSERT_TRUE(read) << datagram.index();
    EXPECT_EQ(read->index(), datagram.index());
    EXPECT_EQ(encode(*read), bytes);
  }
  const auto read = decode_stop(encode(one_of_each()[2]));
  const auto& order = std::get<StopOrder>(*read);
  EXPECT_EQ(order.part, "arm");
  EXPECT_EQ(order.proof, hash(9));
  EXPECT_EQ(std::get<StopActed>(*decode_stop(encode(one_of_each()[4]))).tick, 123'456'789'012);
}

TEST(StopDatagram, KeepsTheLongestNameAndCutsALongerOne) {
  for (const std::size_t length : {std::size_t{0}, kMaxStopPart, kMaxStopPart + 1}) {
    const auto read = decode_stop(encode(StopOrder{nonce(), {}, {}, std::string(length, 'a')}));
    ASSERT_TRUE(read);
    EXPECT_EQ(std::get<StopOrder>(*read).part.size(), std::min(length, kMaxStopPart));
  }
}

// So nobody can use the server to flood another machine.
TEST(StopDatagram, NoAnswerIsLongerThanItsQuestion) {
  EXPECT_LE(encode(StopChallenge{}).size(), kStopAskBytes);
  EXPECT_EQ(encode(StopAsk{}).size(), kStopAskBytes);
  EXPECT_LE(encode(StopLatched{}).size() + encode(StopActed{}).size(), kStopOrderBytes);
  EXPECT_EQ(encode(StopOrder{}).size(), kStopOrderBytes);
}

TEST(StopDatagram, AnythingElseIsRefused) {
  for (const auto& datagram : one_of_each()) {
    const auto good = encode(datagram);
    for (std::size_t length = 0; length < good.size(); ++length)
      EXPECT_FALSE(decode_stop(std::span(good).first(length))) << datagram.index() << " cut to " << length;
    auto longer = good;
    longer.push_back(std::byte{0});
    EXPECT_FALSE(decode_stop(longer)) << datagram.index();
    for (std::size_t i = 0; i < 9; ++i) {  // the magic and the version
      auto other = good;
      other[i] ^= std::byte{1};
      EXPECT_FALSE(decode_stop(other)) << datagram.index() << ", byte " << i;
    }
    for (const int kind : {0, 7, 255}) {
      auto other = good;
      other[9] = std::byte(kind);
      EXPECT_FALSE(decode_stop(other)) << datagram.index() << " as " << kind;
    }
  }
  auto order = encode(StopOrder{nonce(), {}, {}, "arm"});
  order.back() = std::byte{1};
  EXPECT_FALSE(decode_stop(order)) << "something behind the name";
}

TEST(StopDatagram, NoiseIsNeverRead) {
  std::mt19937 random(1);
  for (int i = 0; i < 20'000; ++i) {
    auto bytes = encode(one_of_each()[random() % 6]);
    if (i % 2 == 0) bytes.resize(random() % (kStopOrderBytes + 20));
    for (int changes = 0; changes < 4 && !bytes.empty(); ++changes)
      bytes[random() % bytes.size()] = std::byte(random());
    const auto read = decode_stop(bytes);
    if (read) {
      EXPECT_EQ(encode(*read), bytes);
    }
  }
}

TEST(StopProof, BelongsToOneTokenOneCookieAndOnePart) {
  const auto proof = stop_proof("a-token-of-16-letters", hash(1), "arm");
  EXPECT_EQ(proof, stop_proof("a-token-of-16-letters", hash(1), "arm"));
  EXPECT_NE(proof, stop_proof("another-token-of-16-letters", hash(1), "arm"));
  EXPECT_NE(proof, stop_proof("a-token-of-16-letters", hash(2), "arm"));
  EXPECT_NE(proof, stop_proof("a-token-of-16-letters", hash(1), "cart"));
}

// RFC 4231, test case 2.
TEST(KeyedHashTest, IsHmacSha256) {
  const std::string key = "Jefe", text = "what do ya want for nothing?",
                    expected = "5bdcc146bf60754e6a042426089575c75a003f089d2739839dec58b964ec3843";
  const auto bytes = [](const std::string& of) { return std::as_bytes(std::span(of.data(), of.size())); };
  std::string hex;
  for (const std::byte byte : keyed_hash(bytes(key), bytes(text))) {
    char two[3];
    std::snprintf(two, sizeof two, "%02x", std::to_integer<unsigned>(byte));
    hex += two;
  }
  EXPECT_EQ(hex, expected);
}

// Keys and messages that end before, at and behind the border of a block.
TEST(KeyedHashTest, IsThatOfOpenSsl) {
  std::mt19937 random(1);
  const auto noise = [&](std::size_t size) {
    std::vector<std::byte> bytes(size);
    for (std::byte& byte : bytes) byte = static_cast<std::byte>(random());
    return bytes;
  };
  for (const std::size_t key_size : {0, 1, 32, 63, 64, 65, 200})
    for (std::size_t size = 0; size < 200; ++size) {
      // With room for one more, so that OpenSSL gets an address for no bytes, too.
      std::vector<std::byte> key = noise(key_size + 1), message = noise(size + 1);
      key.pop_back();
      message.pop_back();
      KeyedHash expected;
      ASSERT_NE(HMAC(EVP_sha256(), key.data(), static_cast<int>(key_size),
                     reinterpret_cast<const unsigned char*>(message.data()), size,
                     reinterpret_cast<unsigned char*>(expected.data()), nullptr),
                nullptr);
      EXPECT_EQ(keyed_hash(key, message), expected) << key_size << " " << size;
    }
}

TEST(KeyedHashTest, EveryBitCountsWhereTwoAreCompared) {
  const KeyedHash hash = keyed_hash({}, {});
  EXPECT_TRUE(equal_in_constant_time(hash, hash));
  for (std::size_t bit = 0; bit < 8 * hash.size(); ++bit) {
    KeyedHash other = hash;
    other[bit / 8] ^= std::byte{1} << bit % 8;
    EXPECT_FALSE(equal_in_constant_time(hash, other));
  }
}

}  // namespace
}  // namespace visum::protocol
