#include "clients/visum/common/format.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "protocol/config/printable.h"

namespace visum::cli {
namespace {

using Buffer = std::array<char, 400>;  // a double in fixed notation has at most 309 digits before the point

}  // namespace

std::string exact(double number) {
  Buffer buffer;
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), number).ptr;
  return {buffer.data(), end};
}

std::string rounded(double number, int digits) {
  Buffer buffer;
  const auto end =
      std::to_chars(buffer.data(), buffer.data() + buffer.size(), number, std::chars_format::general, digits)
          .ptr;
  return {buffer.data(), end};
}

std::string fixed(double number, int decimals) {
  Buffer buffer;
  if (std::abs(number) * std::pow(10.0, decimals) < 0.5) number = 0.0;
  const auto end =
      std::to_chars(buffer.data(), buffer.data() + buffer.size(), number, std::chars_format::fixed, decimals)
          .ptr;
  return {buffer.data(), end};
}

std::string readable(double number, int digits) {
  if (std::abs(number) < 1e-300) return "0";
  const bool is_whole = number == std::floor(number) && std::abs(number) < 1e15;
  return is_whole ? fixed(number, 0) : rounded(number, digits);
}

std::string seconds(std::int64_t time_ns) {
  return fixed(static_cast<double>(time_ns) * 1e-9, 3) + " s";
}

std::string hex(std::uint64_t hash) {
  constexpr char kDigits[] = "0123456789abcdef";
  std::string text(16, '0');
  for (auto digit = text.rbegin(); digit != text.rend(); ++digit, hash >>= 4) *digit = kDigits[hash & 15];
  return text;
}

void Table::row(std::vector<std::string> cells) {
  for (auto& cell : cells) cell = config::printable(cell);
  rows_.push_back(std::move(cells));
}

std::string Table::text(const std::string& indent) const {
  std::vector<std::size_t> widths;
  for (const auto& row : rows_) {
    widths.resize(std::max(widths.size(), row.size()));
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
  }
  std::string text;
  for (const auto& row : rows_) {
    text += indent;
    for (std::size_t i = 0; i < row.size(); ++i) {
      text += row[i];
      if (i + 1 < row.size()) text.append(widths[i] - row[i].size() + 2, ' ');
    }
    text += '\n';
  }
  return text;
}

}  // namespace visum::cli
