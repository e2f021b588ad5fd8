// Finroc's bytes with their meaning, and the limits of a session, without a socket and without a server.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "clients/bridges/finroc/greeting.h"
#include "clients/bridges/finroc/records.h"
#include "clients/bridges/finroc/session.h"
#include "clients/bridges/finroc/settings.h"

namespace visum::finroc {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

std::span<const std::byte> bytes_of(const std::string& text) {
  return std::as_bytes(std::span(text));
}

std::string hex(const std::string& bytes) {
  std::string text;
  for (const char byte : bytes) {
    char two[3];
    std::snprintf(two, sizeof two, "%02x", static_cast<unsigned char>(byte));
    text += two;
  }
  return text;
}

const Type kNumberType{Kind::kNumber, "Number", {}};
const Type kTextType{Kind::kText, "String", {}};
const Type kChoiceType{Kind::kChoice, "Colour", {"red", "green"}};

std::string written(const Type& type, const Value& value, std::uint8_t unit = 0) {
  Writer out;
  put_value(out, type, value, unit, Encoding::kBinary);
  return out.text();
}

std::optional<Value> read_back(const Type& type, const std::string& bytes) {
  Reader in(bytes_of(bytes));
  return take_value(in, type, Encoding::kBinary);
}

TEST(FinrocNumber, IsADoubleWithItsUnit) {
  EXPECT_EQ(hex(written(kNumberType, 0.5)), "86000000000000e03f");
  EXPECT_EQ(hex(written(kNumberType, 0.5, unit_code("rad"))), "87000000000000e03f17");
  EXPECT_EQ(hex(written(kNumberType, std::int64_t{2})), "800200000000000000");
}

TEST(Blackboards, AreShownInWords) {
  const auto as_text = [](const std::string& content_type, std::uint64_t row_bytes, const auto& content,
                          std::uint64_t more = 0) {
    const auto bytes = std::as_bytes(std::span(content));
    return shown(content_type, row_bytes, bytes, bytes.size() + more);
  };
  EXPECT_EQ(as_text("text/plain", 1, std::string("hello")), "hello");
  EXPECT_EQ(as_text("text/plain", 1, std::string("hello"), 3), "hello ... (8 bytes)");
  const std::vector<double> rows{0.0, 0.5, 0.1, -2.0};
  EXPECT_EQ(as_text("application/x-float64", 16, rows), "0 0.5; 0.1 -2");
  EXPECT_EQ(as_text("application/x-float64", 8, rows, 8), "0 0.5 0.1 -2 ... (40 bytes)");
  EXPECT_EQ(as_text("application/x-float32", 4, std::vector<float>{0.5f, 2.0f}), "0.5 2");
  EXPECT_EQ(as_text("image/png", 1, rows), "image/png, 32 bytes");
}

TEST(Settings, GoToTheServerInTheTypeOfTheirPort) {
  const auto sent = [](const Type& type, const Value& present, const Value& given) {
    Element element;
    element.type = type;
    element.value = present;
    return to_server(element, given);
  };
  using protocol::ParameterValue;
  EXPECT_EQ(sent(number_type(), 0.5, std::int64_t{2}), ParameterValue(2.0));
  EXPECT_EQ(sent(number_type(), std::int64_t{1}, 2.0), ParameterValue(std::int64_t{2}));
  EXPECT_EQ(sent(number_type(), std::int64_t{1}, 2.5), ParameterValue(2.5));  // which the server refuses
  EXPECT_EQ(sent(number_type(), std::int64_t{1}, 1e300), ParameterValue(1e300));
  EXPECT_EQ(sent(kChoiceType, std::int64_t{0}, std::int64_t{1}), ParameterValue("green"));
  EXPECT_EQ(sent({Kind::kBool, "bool", {}}, false, true), ParameterValue(true));
  EXPECT_EQ(setting_type("motion/Ramp", "Mode", "slow", {"slow", "fast"}).name, "motion/Ramp Mode");
  EXPECT_EQ(setting_type("motion/Ramp", "Mode", "odd", {"slow", "fast"}).kind, Kind::kText);
}

TEST(FinrocNumber, IsReadInEachOfItsForms) {
  using namespace std::string_literals;
  EXPECT_EQ(read_back(kNumberType, "\x86\0\0\0\0\0\0\xe0\x3f"s), Value(0.5));
  EXPECT_EQ(read_back(kNumberType, "\x87\0\0\0\0\0\0\xe0\x3f\x17"s), Value(0.5));
  EXPECT_EQ(read_back(kNumberType, "\x88\0\0\0\x3f"s), Value(0.5));               // float
  EXPECT_EQ(read_back(kNumberType, "\x84\xff\xff"s), Value(std::int64_t{-1}));    // 16 bits
  EXPECT_EQ(read_back(kNumberType, "\x82\x10\0\0\0"s), Value(std::int64_t{16}));  // 32 bits
  EXPECT_EQ(read_back(kNumberType, "\x0a"s), Value(std::int64_t{5}));             // the code itself
  EXPECT_EQ(read_back(kNumberType, "\xf6"s), Value(std::int64_t{-5}));
  EXPECT_EQ(read_back(kNumberType, "\x86\0\0"s), std::nullopt);
  EXPECT_EQ(read_back(kNumberType, "\x8a"s), std::nullopt);  // -59 is no code
}

TEST(FinrocChoice, IsAnIndexWithinItsNames) {
  EXPECT_EQ(hex(written(kChoiceType, std::int64_t{1})), "01");
  EXPECT_EQ(read_back(kChoiceType, std::string(1, '\x01')), Value(std::int64_t{1}));
  EXPECT_EQ(read_back(kChoiceType, std::string(1, '\x02')), std::nullopt);
  EXPECT_EQ(in_text(kChoiceType, std::int64_t{1}), "green");
  EXPECT_EQ(from_text(kChoiceType, "blue"), std::nullopt);
}

TEST(FinrocText, IsReadWithItsUnitLeftOff) {
  EXPECT_EQ(from_text(kNumberType, "-0.25"), Value(-0.25));
  EXPECT_EQ(from_text(kNumberType, "0.5 furlongs"), std::nullopt);
  EXPECT_EQ(from_text(kNumberType, ""), std::nullopt);
}

TEST(FinrocTypes, AreDescribedOnceForEachPeer) {
  TypesSent types;
  Writer first, second, choice;
  types.put(first, kNumberType);
  types.put(second, kNumberType);
  types.put(choice, kChoiceType);
  // descriptions follow; usual interval 40 ms; number 0, no interval, class 1, name, traits 3; end; number 0
  EXPECT_EQ(hex(first.text()),
            "feff"
            "2800"
            "0000"
            "ffff"
            "01"
            "4e756d62657200"
            "03"
            "ffff"
            "0000");
  EXPECT_EQ(hex(second.text()), "0000");
  EXPECT_EQ(hex(choice.text()),
            "feff"
            "0100"
            "ffff"
            "01"
            "436f6c6f757200"
            "0b"
            "0200"
            "72656400"
            "677265656e00"
            "ffff"
            "0100");
  TypesHeard heard;
  const std::string said = first.text() + second.text() + choice.text();
  Reader in(bytes_of(said));
  EXPECT_EQ(heard.take(in), "Number");
  EXPECT_EQ(heard.take(in), "Number");
  EXPECT_EQ(heard.take(in), "Colour");
  EXPECT_TRUE(in.at_end());
  EXPECT_FALSE(in.failed());
}

TEST(FinrocRecord, SaysWhatFinstructDraws) {
  Board board;
  const auto group = board.add_group(kRoot, "g");
  const auto port = board.add_port(group, "p", kNumberType, Access::kWrite, 0.0);
  const auto target = board.add_port(group, "q", kNumberType, Access::kRead, 0.0);
  board.add_edge(port, target);
  TypesSent types;
  Writer of_group, of_port;
  put_record(of_group, board, group, Structure::kFinstruct, types);
  // handle 4096, one link "g" below the root, flags ready and published, one tag
  EXPECT_EQ(hex(of_group.text()),
            "00100000"
            "01"
            "6700"
            "00"
            "00000000"
            "00008001"
            "01"
            "01000000"
            "01"
            "67726f757000");
  types.put(of_port, kNumberType);
  of_port = Writer();
  put_record(of_port, board, port, Structure::kFinstruct, types);
  // strategy 1, no interval; one edge, not made by finstruct; no tags
  EXPECT_EQ(hex(of_port.text()),
            "00200000"
            "81"
            "7000"
            "00"
            "00100000"
            "0000"
            "01228041"
            "0100"
            "ffff"
            "01"
            "00300000"
            "00"
            "00");
}

TEST(FinrocBoard, ForgetsAnElementWithAllBelowIt) {
  Board board;
  const auto group = board.add_group(kRoot, "g");
  const auto port = board.add_port(group, "p", kNumberType, Access::kWrite, 0.0);
  EXPECT_EQ(board.path(port), "/g/p");
  board.remove(group);
  EXPECT_FALSE(board.is_living_port(port));
  ASSERT_EQ(board.changes().size(), 4u);
  EXPECT_EQ(board.changes()[2].id, port);  // children first
  EXPECT_EQ(board.changes()[3].id, group);
}

// ---------------------------------------- sessions

std::string greeting(std::uint32_t flags, Structure wants) {
  return write_greeting({"here", -7, 0, "a peer", wants, flags});
}
std::string batch(const std::string& messages, std::int16_t number = -1) {
  Writer out;
  out.put(static_cast<std::uint32_t>(4 + messages.size())).put(number).put(std::int16_t{-1});
  return out.put_bytes(messages).text();
}
std::string subscribe(ElementId port, std::int32_t as, std::int16_t interval_ms = 0) {
  Writer out;
  out.put(std::uint8_t{0}).put(handle_of(port)).put(std::int16_t{1}).put_bool(false).put(interval_ms);
  return out.put(as).put(std::uint8_t{0}).put(kEndMark).text();
}
std::string value(ElementId port, std::uint8_t change, double number) {
  Writer body;
  body.put(handle_of(port)).put(std::uint8_t{0}).put(change).put(std::int64_t{0});
  put_value(body, kNumberType, number, 0, Encoding::kBinary);
  body.put_bool(false).put(kEndMark);
  Writer out;
  out.put(std::uint8_t{10}).put(static_cast<std::uint32_t>(body.text().size()));
  return out.put_bytes(body.text()).text();
}

class FinrocSession : public testing::Test {
 protected:
  FinrocSession() {
    port_ = board_.add_port(board_.add_group(kRoot, "g"), "p", kNumberType, Access::kWrite, 0.25);
    output_ = board_.add_port(kRoot, "o", kNumberType, Access::kRead, 0.0);
    board_.write = [this](ElementId id, const Value& value, const std::string&) {
      writes_.emplace_back(id, std::get<double>(value));
      return refusal_;
    };
  }
  void hear(const std::string& bytes) { session_.receive(bytes_of(bytes)); }
  // Returns what the session sends now.
  std::string say() {
    session_.send_due(now_);
    return std::exchange(session_.output(), {});
  }
  void begin() {
    hear(greeting(connection::kExpress, Structure::kNone));
    say();
  }

  Board board_;
  ElementId port_ = 0, output_ = 0;
  std::vector<std::pair<ElementId, double>> writes_;
  std::string refusal_;
  Session session_{board_, {"visum", 4444, 1, "Visum", Structure::kNone, 0}};
  bridge::Clock::time_point now_{};
};

TEST_F(FinrocSession, AnswersTheGreetingWithTheFlagsThatItKnows) {
  hear(greeting(connection::kExpress | connection::kJava | 0x06A70000u, Structure::kNone));
  const std::string said = say();
  const auto read = read_greeting(bytes_of(said));
  EXPECT_EQ(read.state, GreetingRead::State::kComplete);
  EXPECT_EQ(read.greeting.flags, connection::kExpress);  // the upper half 0: serialization revision 0
  EXPECT_EQ(read.greeting.process, 4444);
}

TEST_F(FinrocSession, TakesItsBytesInAnyPieces) {
  const std::string all =
      greeting(connection::kExpress, Structure::kNone) + batch(value(port_, 1, 0.5)) + batch("", 3);
  for (const char byte : all) hear(std::string(1, byte));
  EXPECT_THAT(writes_, ElementsAre(std::pair(port_, 0.5)));
  EXPECT_THAT(hex(say()), testing::EndsWith("04000000"
                                            "ffff"
                                            "0300"));  // acknowledges batch 3
}

TEST_F(FinrocSession, SendsTheStructureOnThePrimaryConnectionOnly) {
  hear(greeting(connection::kPrimary | connection::kBulk, Structure::kFinstruct));
  const std::string said = say();
  EXPECT_THAT(said, HasSubstr("Number"));
  EXPECT_THAT(hex(said), testing::EndsWith("00000000"));
  EXPECT_EQ(said.substr(said.size() - 5, 1), std::string(1, '\0'));  // the last record's tags: none
}

TEST_F(FinrocSession, SharedPortsGoByTheirPath) {
  hear(greeting(connection::kPrimary, Structure::kSharedPorts));
  const std::string said = say();
  EXPECT_THAT(said, HasSubstr("String"));  // comes first
  EXPECT_THAT(said, HasSubstr(std::string("g/p\0", 4)));
}

TEST_F(FinrocSession, SendsASubscribedValueAtOnceAndThenOnChange) {
  begin();
  hear(batch(subscribe(port_, 77, 40)));
  const std::string first = hex(say());
  EXPECT_THAT(first, HasSubstr("4d000000"
                               "00"
                               "02"));  // the peer's own handle, binary, initial
  EXPECT_THAT(say(), IsEmpty());
  board_.set(port_, 0.5, 1);
  EXPECT_THAT(say(), IsEmpty());  // not faster than the interval
  now_ += std::chrono::milliseconds(40);
  EXPECT_THAT(hex(say()), HasSubstr("4d000000"
                                    "00"
                                    "01"));
}

// 25 values a second are 25, though the bridge looks only each 20 ms, and not on the dot.
TEST_F(FinrocSession, ALateValueDoesNotDelayTheNext) {
  begin();
  hear(batch(subscribe(port_, 77, 40)));
  say();
  int values = 0;
  for (int i = 1; i <= 51; ++i) {  // a second
    now_ += std::chrono::milliseconds(i % 3 == 0 ? 22 : 19);
    board_.set(port_, i, i);
    values += say().empty() ? 0 : 1;
  }
  EXPECT_EQ(values, 25);
}

TEST_F(FinrocSession, UnsubscribedPortsAreSilent) {
  begin();
  hear(batch(subscribe(port_, 77)));
  say();
  EXPECT_LT(session_.follows_every(), bridge::PeerSession::kNever);
  hear(batch(Writer().put(std::uint8_t{1}).put(handle_of(port_)).put(kEndMark).text()));
  board_.set(port_, 0.5, 1);
  EXPECT_THAT(say(), IsEmpty());
  EXPECT_EQ(session_.follows_every(), bridge::PeerSession::kNever);
}

TEST_F(FinrocSession, AnInitialValueCommandsNothing) {
  begin();
  hear(batch(value(port_, 2, 0.0)));
  EXPECT_THAT(writes_, IsEmpty());
  hear(batch(value(port_, 1, 0.0)));
  EXPECT_THAT(writes_, ElementsAre(std::pair(port_, 0.0)));
}

TEST_F(FinrocSession, NobodyWritesAnOutput) {
  begin();
  hear(batch(value(output_, 1, 1.0)));
  EXPECT_THAT(writes_, IsEmpty());
}

TEST_F(FinrocSession, ARefusedWriteBringsTheOldValueBack) {
  begin();
  hear(batch(subscribe(port_, 77)));
  say();
  refusal_ = "leased by another";
  hear(batch(value(port_, 1, 9.0)));
  EXPECT_THAT(hex(say()), HasSubstr("86000000000000d03f"));  // 0.25
}

TEST_F(FinrocSession, TellsOfElementsThatComeAndGo) {
  hear(greeting(connection::kPrimary, Structure::kFinstruct) + std::string(4, '\0'));
  say();
  const auto module = board_.add_module(kRoot, "newcomer");
  EXPECT_THAT(say(), HasSubstr("newcomer"));
  board_.remove(module);
  EXPECT_THAT(hex(say()), testing::EndsWith("08"
                                            "00400000"
                                            "cd"));
}

TEST_F(FinrocSession, ServesCallsAndRefusesThoseThatItDoesNotKnow) {
  const auto services = board_.add_administration(kRoot, "Administration");
  begin();
  TypesSent types;
  const auto call = [&](std::uint8_t method, const std::string& arguments) {
    Writer body;
    body.put(handle_of(services)).put(std::uint8_t{1});
    types.put(body, {Kind::kAdministration, "Administration Interface", {}});
    body.put(method).put(std::int64_t{42}).put(std::int64_t{0}).put_bytes(arguments).put(kEndMark);
    Writer out;
    out.put(std::uint8_t{4}).put(static_cast<std::uint32_t>(body.text().size())).put_bytes(body.text());
    hear(batch(out.text()));
    return hex(say());
  };
  const std::string id = "2a00000000000000";
  EXPECT_THAT(call(9, ""), HasSubstr("09" + id +
                                     "00"
                                     "01"
                                     "00"
                                     "cd"));
  EXPECT_THAT(call(1, "xyz"), HasSubstr("01" + id +
                                        "00"
                                        "07"
                                        "cd"));
  // setPortValue with an empty answer, which means that it was accepted
  Writer buffer, arguments;
  buffer.put(std::uint8_t{0}).put_bytes(written(kNumberType, 0.75));
  arguments.put(handle_of(port_)).put(static_cast<std::int64_t>(buffer.text().size()));
  arguments.put_bytes(buffer.text());
  EXPECT_THAT(call(15, arguments.text()), HasSubstr("0f" + id +
                                                    "00"
                                                    "01"
                                                    "00"
                                                    "cd"));
  EXPECT_THAT(writes_, ElementsAre(std::pair(port_, 0.75)));
  refusal_ = "no";
  EXPECT_THAT(call(15, arguments.text()), HasSubstr("0f" + id +
                                                    "00"
                                                    "01"
                                                    "6e6f00"
                                                    "cd"));
}

TEST_F(FinrocSession, SkipsTheRestOfABatchThatItDoesNotUnderstand) {
  begin();
  hear(batch(std::string("\x63garbage") + value(port_, 1, 1.0)));
  EXPECT_THAT(session_.ended(), IsEmpty());
  hear(batch(value(port_, 1, 2.0)));
  EXPECT_THAT(writes_, ElementsAre(std::pair(port_, 2.0)));
}

TEST_F(FinrocSession, EndsWithAReasonWhereNothingFits) {
  hear("GET / HTTP/1.1\r\n");
  EXPECT_THAT(session_.ended(), HasSubstr("Finroc"));
  Session long_batch{board_, {}};
  const std::string said = greeting(connection::kExpress, Structure::kNone) + std::string("\xff\xff\xff\x7f");
  long_batch.receive(bytes_of(said));
  EXPECT_THAT(long_batch.ended(), HasSubstr("2147483647 bytes"));
}

TEST_F(FinrocSession, EndsAPeerThatOnlyAsks) {
  begin();
  std::string pull;
  for (int i = 0; i < 1000; ++i) {
    Writer one;
    one.put(std::uint8_t{2}).put(handle_of(port_)).put(std::int64_t{i}).put(std::uint8_t{0}).put(kEndMark);
    pull += one.text();
  }
  for (int i = 0; i < 2000 && session_.ended().empty(); ++i) hear(batch(pull));
  EXPECT_THAT(session_.ended(), HasSubstr("more than it reads"));
}

}  // namespace
}  // namespace visum::finroc
