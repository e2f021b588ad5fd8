#include "protocol/part_description.h"

#include <algorithm>
#include <cmath>

namespace visum::protocol {
namespace {

constexpr double kMostBits = 9007199254740992.0;  // 2^53: beyond it a double holds no single bits
constexpr int kBits = 53;

const std::string* name_of(const std::vector<NumberName>& names, std::int64_t number) {
  const auto found =
      std::ranges::find_if(names, [&](const NumberName& name) { return name.number == number; });
  return found == names.end() ? nullptr : &found->name;
}

}  // namespace

std::string in_words(const Port& port, double value) {
  if (!(std::abs(value) < kMostBits) || value != std::floor(value)) return "";
  const auto number = static_cast<std::int64_t>(value);
  if (const auto* name = name_of(port.values, number)) return *name;
  if (port.bits.empty() || number < 0) return "";
  std::string words;
  for (int bit = 0; bit < kBits; ++bit) {
    if ((number >> bit & 1) == 0) continue;
    const auto* name = name_of(port.bits, bit);
    words += (words.empty() ? "" : " ") + (name ? *name : "bit " + std::to_string(bit));
  }
  return words;
}

}  // namespace visum::protocol
