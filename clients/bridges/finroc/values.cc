#include "clients/bridges/finroc/values.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <utility>

namespace visum::finroc {
namespace {

// The first byte of a Number is a signed code times two, plus one if a unit follows the number.
constexpr int kInt64 = -64, kInt32 = -63, kInt16 = -62, kDouble = -61, kFloat = -60;
constexpr int kLeastSmall = -58, kMostSmall = 63;  // these codes are the number itself

constexpr std::array<std::pair<const char*, std::uint8_t>, 7> kUnits = {
    {{"mm", 3}, {"m", 6}, {"m/s", 9}, {"s", 18}, {"deg", 22}, {"rad", 23}, {"Hz", 24}}};

void put_number(Writer& out, const Value& value, std::uint8_t unit) {
  const int with_unit = unit != 0 ? 1 : 0;
  if (const auto* whole = std::get_if<std::int64_t>(&value)) {
    out.put(static_cast<std::int8_t>(kInt64 * 2 + with_unit)).put(*whole);
  } else {
    const auto* number = std::get_if<double>(&value);
    out.put(static_cast<std::int8_t>(kDouble * 2 + with_unit)).put(number != nullptr ? *number : 0.0);
  }
  if (unit != 0) out.put(unit);
}

// Small whole numbers are their code.
Value take_number_of(Reader& in, int code) {
  switch (code) {
    case kInt64:
      return in.take<std::int64_t>();
    case kInt32:
      return static_cast<std::int64_t>(in.take<std::int32_t>());
    case kInt16:
      return static_cast<std::int64_t>(in.take<std::int16_t>());
    case kDouble:
      return in.take<double>();
    case kFloat:
      return static_cast<double>(in.take<float>());
    default:
      if (code < kLeastSmall || code > kMostSmall) in.fail();
      return static_cast<std::int64_t>(code);
  }
}

std::optional<Value> take_number(Reader& in) {
  const auto first = in.take<std::int8_t>();
  const bool with_unit = (first & 1) != 0;
  std::optional<Value> value = take_number_of(in, (first - (with_unit ? 1 : 0)) / 2);
  if (with_unit) in.take<std::uint8_t>();
  if (in.failed()) value.reset();
  return value;
}

std::optional<Value> take_choice(Reader& in, const Type& type) {
  // The width of an index follows from how many names there are.
  const std::int64_t index = type.choices.size() <= 256 ? in.take<std::uint8_t>() : in.take<std::int16_t>();
  if (!in.failed() && (index < 0 || static_cast<std::size_t>(index) >= type.choices.size())) in.fail();
  if (in.failed()) return std::nullopt;
  return index;
}

std::optional<Value> take_binary(Reader& in, const Type& type) {
  switch (type.kind) {
    case Kind::kNumber:
      return take_number(in);
    case Kind::kChoice:
      return take_choice(in, type);
    case Kind::kBool: {
      const bool flag = in.take_bool();
      if (in.failed()) return std::nullopt;
      return flag;
    }
    case Kind::kText: {
      std::string text = in.take_string();
      if (in.failed()) return std::nullopt;
      return text;
    }
    case Kind::kAdministration:
      break;
  }
  in.fail();
  return std::nullopt;
}

std::string shortest(double number) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), number).ptr;
  return {text.data(), end};
}

// A number, with or without a unit behind it. A unit is only accepted where the value is in it already.
std::optional<Value> number_from(const std::string& text) {
  double number = 0.0;
  const char* end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, number);
  if (error != std::errc()) return std::nullopt;
  const std::string_view unit = std::string_view(rest, static_cast<std::size_t>(end - rest));
  if (unit.find_first_not_of(' ') != std::string_view::npos) return std::nullopt;
  return number;
}

}  // namespace

std::uint8_t unit_code(const std::string& unit) {
  const auto* found =
      std::find_if(kUnits.begin(), kUnits.end(), [&](const auto& row) { return unit == row.first; });
  return found == kUnits.end() ? 0 : found->second;
}

void put_value(Writer& out, const Type& type, const Value& value, std::uint8_t unit, Encoding encoding) {
  if (encoding == Encoding::kText) {
    out.put_string(in_text(type, value));
    return;
  }
  switch (type.kind) {
    case Kind::kNumber:
      put_number(out, value, unit);
      break;
    case Kind::kBool:
      out.put_bool(std::get<bool>(value));
      break;
    case Kind::kText:
      out.put_string(std::get<std::string>(value));
      break;
    case Kind::kChoice: {
      const auto index = std::get<std::int64_t>(value);
      if (type.choices.size() <= 256) {
        out.put(static_cast<std::uint8_t>(index));
      } else {
        out.put(static_cast<std::int16_t>(index));
      }
      break;
    }
    case Kind::kAdministration:
      break;
  }
}

std::optional<Value> take_value(Reader& in, const Type& type, Encoding encoding) {
  if (encoding == Encoding::kBinary) return take_binary(in, type);
  if (encoding == Encoding::kText) {
    const std::string text = in.take_string();
    auto value = in.failed() ? std::nullopt : from_text(type, text);
    if (!value) in.fail();
    return value;
  }
  in.fail();
  return std::nullopt;
}

std::string in_text(const Type& type, const Value& value) {
  if (const auto* number = std::get_if<double>(&value)) return shortest(*number);
  if (const auto* flag = std::get_if<bool>(&value)) return *flag ? "true" : "false";
  if (const auto* text = std::get_if<std::string>(&value)) return *text;
  const auto whole = std::get<std::int64_t>(value);
  if (type.kind == Kind::kChoice) return type.choices.at(static_cast<std::size_t>(whole));
  return std::to_string(whole);
}

std::optional<Value> from_text(const Type& type, const std::string& text) {
  switch (type.kind) {
    case Kind::kNumber:
      return number_from(text);
    case Kind::kText:
      return text;
    case Kind::kBool:
      if (text == "true" || text == "1") return true;
      if (text == "false" || text == "0") return false;
      return std::nullopt;
    case Kind::kChoice: {
      const auto found = std::find(type.choices.begin(), type.choices.end(), text);
      if (found == type.choices.end()) return std::nullopt;
      return static_cast<std::int64_t>(found - type.choices.begin());
    }
    case Kind::kAdministration:
      break;
  }
  return std::nullopt;
}

}  // namespace visum::finroc
