// The result of something that may be refused: a plain value, so that bad input from a client, a bus or a
// file never travels as an exception. All functions of the cycle that may refuse return one. Bad
// configuration is another matter: it throws config::ConfigError before the first tick.
#pragma once

#include <optional>
#include <string>
#include <utility>

namespace visum::cycle {

// Why something was refused, for programs. The text beside it is for people.
enum class Refusal {
  kNone,         // it was done
  kUnknownName,  // there is no part, body, fault or snapshot of that name or number
  kBadValue,     // a value that the world, the scene or the part does not take
  kWrongState,   // the same request may succeed once the world has changed
  kFull,         // a list with a fixed limit is full
  kNoMemory,     // memory ran out
  kDamaged,      // a saved state that does not belong to this world
};

// Either done, or refused with a reason and a text. A refused call has changed nothing, unless its function
// says otherwise. Being done costs no allocation; a refusal allocates its text.
class [[nodiscard]] Outcome {
 public:
  Outcome() = default;  // done
  Outcome(Refusal refusal, std::string text) : refusal_(refusal), text_(std::move(text)) {}

  bool done() const { return refusal_ == Refusal::kNone; }
  Refusal refusal() const { return refusal_; }
  const std::string& text() const { return text_; }  // says what is wrong and where; empty: done

 private:
  Refusal refusal_ = Refusal::kNone;
  std::string text_;
};

// Parts refuse by a text alone (hwparts/part.h): what they refuse is a bad value.
inline Outcome outcome_of(std::optional<std::string> refusal_of_part) {
  if (!refusal_of_part) return {};
  return {Refusal::kBadValue, std::move(*refusal_of_part)};
}

}  // namespace visum::cycle
