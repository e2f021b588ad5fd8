#include "clients/bridges/finroc/greeting.h"

#include <algorithm>
#include <string_view>

#include "clients/bridges/finroc/bytes.h"

namespace visum::finroc {
namespace {

constexpr std::string_view kText = "Greetings! I am a Finroc TCP peer.";
constexpr std::uint16_t kVersion = 1;
constexpr std::size_t kMostBytes = 1024;  // of what follows the text
constexpr std::size_t kHead = 2 + 4;      // version and length

GreetingRead bad(std::string why) {
  return {GreetingRead::State::kBad, 0, {}, std::move(why)};
}

GreetingRead read_body(std::span<const std::byte> body) {
  Reader in(body);
  Greeting greeting;
  greeting.host = in.take_string();
  greeting.process = in.take<std::int32_t>();
  greeting.peer_type = in.take<std::uint8_t>();
  greeting.name = in.take_string();
  const auto wants = in.take<std::uint8_t>();
  greeting.flags = in.take<std::uint32_t>();
  in.take_bytes(in.take_bool() ? 16 : 4);  // our address, as the peer sees it
  const auto mark = in.take<std::uint8_t>();
  if (in.failed() || mark != kEndMark) return bad("its greeting is broken");
  if (wants > static_cast<std::uint8_t>(Structure::kFinstruct)) return bad("it wants an unknown structure");
  greeting.wants = static_cast<Structure>(wants);
  return {GreetingRead::State::kComplete, 0, std::move(greeting), {}};
}

}  // namespace

GreetingRead read_greeting(std::span<const std::byte> bytes) {
  const std::string_view said(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const std::string_view with_end(kText.data(), kText.size() + 1);
  const auto common = std::min(said.size(), with_end.size());
  if (said.substr(0, common) != with_end.substr(0, common)) return bad("it does not speak Finroc's protocol");
  if (said.size() < with_end.size() + kHead) return {};
  Reader in(bytes.subspan(with_end.size()));
  const auto version = in.take<std::uint16_t>();
  const auto length = in.take<std::uint32_t>();
  if (version != kVersion) return bad("it speaks version " + std::to_string(version) + ", not 1");
  if (length > kMostBytes) return bad("its greeting is too long");
  if (in.left() < length) return {};
  GreetingRead read = read_body(in.take_bytes(length));
  read.taken = with_end.size() + kHead + length;
  return read;
}

std::string write_greeting(const Greeting& greeting) {
  Writer body;
  body.put_string(greeting.host).put(greeting.process).put(greeting.peer_type).put_string(greeting.name);
  body.put(static_cast<std::uint8_t>(greeting.wants)).put(greeting.flags);
  body.put_bool(false).put(std::uint8_t{127}).put(std::uint8_t{0}).put(std::uint8_t{0}).put(std::uint8_t{1});
  body.put(kEndMark);
  Writer all;
  all.put_string(kText).put(kVersion).put(static_cast<std::uint32_t>(body.text().size()));
  return all.put_bytes(body.text()).text();
}

}  // namespace visum::finroc
