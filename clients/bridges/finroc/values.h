// Finroc's types as far as the bridge uses them, and values of these types in both of their encodings.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "clients/bridges/finroc/bytes.h"

namespace visum::finroc {

enum class Kind { kNumber, kBool, kText, kChoice, kAdministration };

struct Type {
  Kind kind = Kind::kNumber;
  std::string name;                  // as peers see it
  std::vector<std::string> choices;  // for kChoice: the names of the values 0, 1, ...
};

inline Type number_type() {
  return {Kind::kNumber, "Number", {}};
}

// A number, a flag, a text, or the index of a choice.
using Value = std::variant<double, std::int64_t, bool, std::string>;

// How a value is written: its bytes, or text.
enum class Encoding : std::uint8_t { kBinary = 0, kText = 1, kXml = 2 };

// The unit as Finroc numbers it, which travels with each Number. 0: none, or one that Finroc does not know.
std::uint8_t unit_code(const std::string& unit);

void put_value(Writer& out, const Type& type, const Value& value, std::uint8_t unit, Encoding encoding);
// Returns nothing, and leaves `in` failed, if the bytes are no such value.
std::optional<Value> take_value(Reader& in, const Type& type, Encoding encoding);

// The value as a person would type it.
std::string in_text(const Type& type, const Value& value);
std::optional<Value> from_text(const Type& type, const std::string& text);

}  // namespace visum::finroc
