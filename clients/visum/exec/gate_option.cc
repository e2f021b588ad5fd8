#include "clients/visum/exec/gate_option.h"

#include <charconv>
#include <set>

#include "clients/visum/common/exit_code.h"

namespace visum::exec {
namespace {

constexpr std::uint32_t kMostModule = 31;
constexpr std::size_t kMostBytes = 8;

[[noreturn]] void refuse_gate(const std::string& text) {
  throw cli::ExitError(cli::kUsage,
                       "--gate " + text +
                           ": must be bus, bus:PART, bus:PART=MODULE:BYTES (a module from 1 to 31, "
                           "and up to 8 bytes as hex digits: bus:arm=7:0B10), ports or "
                           "ports:CLIENT");
}

template <typename T>
bool parse_whole(std::string_view text, int base, T& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, base);
  return error == std::errc() && end == text.data() + text.size();
}

// "7:0B10"
bool parse_frame(std::string_view text, protocol::Gate& gate) {
  const auto colon = text.find(':');
  if (colon == text.npos || !parse_whole(text.substr(0, colon), 10, gate.module)) return false;
  const auto digits = text.substr(colon + 1);
  if (digits.empty() || digits.size() % 2 != 0 || digits.size() > 2 * kMostBytes) return false;
  for (std::size_t at = 0; at < digits.size(); at += 2) {
    std::uint8_t byte = 0;
    if (!parse_whole(digits.substr(at, 2), 16, byte)) return false;
    gate.frame.push_back(std::byte{byte});
  }
  return gate.module >= 1 && gate.module <= kMostModule;
}

}  // namespace

GateOption parse_gate(const std::string& text) {
  const auto colon = text.find(':');
  const auto kind = text.substr(0, colon);
  const auto rest = colon == text.npos ? std::string() : text.substr(colon + 1);
  if ((kind != "bus" && kind != "ports") || (colon != text.npos && rest.empty())) refuse_gate(text);
  GateOption option{kind == "bus", {}};
  if (!option.on_bus) return option.gate.client = rest, option;
  const auto equals = rest.find('=');
  option.gate.part = rest.substr(0, equals);
  const bool good = equals == rest.npos ||
                    (equals > 0 && parse_frame(std::string_view(rest).substr(equals + 1), option.gate));
  if (!good) refuse_gate(text);
  return option;
}

protocol::Gate gate_of(const GateOption& option, const std::vector<protocol::PartBus>& buses,
                       const std::string& program) {
  auto gate = option.gate;
  if (!option.on_bus && gate.client.empty()) gate.client = program;
  if (!option.on_bus || !gate.part.empty()) return gate;
  std::set<std::string> parts;
  for (const auto& bus : buses) parts.insert(bus.part);
  if (parts.size() != 1)
    throw cli::ExitError(cli::kUsage,
                         std::string("--gate bus: ") +
                             (parts.empty() ? "no part has a bus (visumd --bus PART=pty:PATH)"
                                            : "several parts have a bus; name one: bus:" + *parts.begin()));
  gate.part = *parts.begin();
  return gate;
}

}  // namespace visum::exec
