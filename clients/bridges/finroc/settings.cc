#include "clients/bridges/finroc/settings.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "protocol/config/number_text.h"

namespace visum::finroc {
namespace {

constexpr std::size_t kMostShownBytes = 16u << 10;  // of a blackboard; the rest is not shown
constexpr std::size_t kMostChoices = 256;

template <typename T>
std::string number_at(std::span<const std::byte> data, std::size_t at) {
  T number;
  std::memcpy(&number, data.data() + at, sizeof number);
  return config::number_text(static_cast<double>(number));
}

// "0 0.5; 0.1 0.6": a row after the other.
template <typename T>
std::string numbers(std::span<const std::byte> data, std::uint64_t row_bytes) {
  std::string text;
  for (std::size_t at = 0; at + sizeof(T) <= data.size(); at += sizeof(T)) {
    const bool begins_row = row_bytes > sizeof(T) && at % row_bytes == 0;
    text += (at == 0 ? "" : begins_row ? "; " : " ") + number_at<T>(data, at);
  }
  return text;
}

}  // namespace

Type setting_type(const std::string& owner, const std::string& name, const protocol::ParameterValue& value,
                  const std::vector<std::string>& choices) {
  if (std::holds_alternative<bool>(value)) return {Kind::kBool, "bool", {}};
  const auto* text = std::get_if<std::string>(&value);
  if (text == nullptr) return number_type();
  if (choices.empty() || choices.size() > kMostChoices) return text_type();
  if (std::ranges::find(choices, *text) == choices.end()) return text_type();
  return {Kind::kChoice, owner + " " + name, choices};
}

Value to_board(const Type& type, const protocol::ParameterValue& value) {
  if (type.kind == Kind::kChoice) {
    const auto found = std::ranges::find(type.choices, std::get<std::string>(value));
    return static_cast<std::int64_t>(found == type.choices.end() ? 0 : found - type.choices.begin());
  }
  return std::visit([](const auto& content) { return Value(content); }, value);
}

double as_double(const Value& value) {
  if (const auto* whole = std::get_if<std::int64_t>(&value)) return static_cast<double>(*whole);
  if (const auto* on = std::get_if<bool>(&value)) return *on ? 1.0 : 0.0;
  return std::get<double>(value);
}

protocol::ParameterValue to_server(const Element& element, const Value& value) {
  if (element.type.kind == Kind::kChoice) return in_text(element.type, value);
  if (element.type.kind == Kind::kBool) return std::get<bool>(value);
  if (element.type.kind == Kind::kText) return std::get<std::string>(value);
  const auto* whole = std::get_if<std::int64_t>(&value);
  if (std::holds_alternative<double>(element.value)) return as_double(value);
  if (whole != nullptr) return *whole;
  const double given = std::get<double>(value);
  constexpr double kMostWhole = 9e15;  // beyond it a double has no single digits
  if (std::abs(given) < kMostWhole && given == std::trunc(given)) return static_cast<std::int64_t>(given);
  return given;  // the server refuses it with the reason
}

std::string shown(const std::string& content_type, std::uint64_t row_bytes, std::span<const std::byte> head,
                  std::uint64_t total_bytes) {
  head = head.first(std::min(head.size(), kMostShownBytes));
  const std::string rest =
      head.size() < total_bytes ? " ... (" + std::to_string(total_bytes) + " bytes)" : "";
  if (content_type.starts_with("text/") || content_type.ends_with("json"))
    return std::string(reinterpret_cast<const char*>(head.data()), head.size()) + rest;
  if (content_type == "application/x-float64") return numbers<double>(head, row_bytes) + rest;
  if (content_type == "application/x-float32") return numbers<float>(head, row_bytes) + rest;
  return content_type + ", " + std::to_string(total_bytes) + " bytes";
}

}  // namespace visum::finroc
