// Any bytes of a Finroc peer. A session must survive them, write only values that are of their port's type,
// and keep what waits for the peer within its bound.
#include <cstdio>
#include <cstdlib>

#include "clients/bridges/finroc/session.h"

namespace {

using namespace visum;
using namespace visum::finroc;

[[noreturn]] void fail(const char* what) {
  std::fprintf(stderr, "%s\n", what);
  std::abort();
}

void check_written(const Element& element, const Value& value) {
  if (element.access != Access::kWrite) fail("an output was written");
  const bool is_number = std::holds_alternative<double>(value) || std::holds_alternative<std::int64_t>(value);
  if (element.type.kind == Kind::kNumber && !is_number) fail("a number became something else");
  if (element.type.kind == Kind::kBool && !std::holds_alternative<bool>(value)) fail("a flag became another");
  if (element.type.kind == Kind::kChoice) in_text(element.type, value);  // throws beyond the last choice
}

void fill(Board& board) {
  const auto module = board.add_module(board.add_group(kRoot, "scene"), "arm");
  const auto inputs = board.add_interface(module, "Controller Input", flag::kControllerData);
  board.add_port(inputs, "number", {Kind::kNumber, "Number", {}}, Access::kWrite, 0.0, 23);
  board.add_port(inputs, "flag", {Kind::kBool, "bool", {}}, Access::kWrite, false);
  board.add_port(inputs, "text", {Kind::kText, "String", {}}, Access::kWrite, std::string());
  board.add_port(inputs, "choice", {Kind::kChoice, "c", {"a", "b"}}, Access::kWrite, std::int64_t{0});
  board.add_port(module, "output", {Kind::kNumber, "Number", {}}, Access::kRead, 0.0);
  board.add_administration(kRoot, "Administration");
}

void serve(std::span<const std::byte> bytes) {
  Board board;
  fill(board);
  std::size_t writes = 0;
  board.write = [&](ElementId id, const Value& value, const std::string&) {
    check_written(board.elements()[id], value);
    board.set(id, value, 1);
    return ++writes % 2 == 0 ? std::string("refused") : std::string();
  };
  Session session(board, {"visum", 4444, 1, "Visum", Structure::kNone, 0});
  bridge::Clock::time_point now{};
  while (!bytes.empty()) {
    const std::size_t piece = std::min<std::size_t>(bytes.size(), 97);
    session.receive(bytes.first(piece));
    bytes = bytes.subspan(piece);
    now += std::chrono::milliseconds(50);
    session.send_due(now);
    if (session.output().size() > (64u << 20)) fail("too much waits for the peer");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto bytes = std::as_bytes(std::span(data, size));
  serve(bytes);
  // Once more behind a good greeting, which a fuzzer rarely finds.
  const std::string greeting =
      write_greeting({"here", -1, 0, "peer", Structure::kNone, connection::kExpress});
  std::vector<std::byte> greeted(bytes.begin(), bytes.end());
  const auto head = std::as_bytes(std::span(greeting));
  greeted.insert(greeted.begin(), head.begin(), head.end());
  serve(greeted);
  return 0;
}
