// Faults: requests about them, and the list of their kinds.
#include "protocol/wire.h"
#include "visum.pb.h"

namespace visum::protocol::wire {
namespace {

template <typename Message>
void put_numbers_of(const std::vector<FaultNumber>& from, Message& to) {
  for (const auto& number : from) {
    auto& w = *to.add_numbers();
    w.set_name(number.name);
    w.set_value(number.value);
  }
}

template <typename Message>
std::vector<FaultNumber> numbers_of(const Message& from) {
  std::vector<FaultNumber> numbers;
  for (const auto& w : from.numbers()) numbers.push_back({w.name(), w.value()});
  return numbers;
}

void put(const FaultKind& from, v1::FaultKind& to) {
  to.set_name(from.name);
  to.set_target(from.target);
  to.set_effect(from.effect);
  for (const auto& number : from.numbers) {
    auto& w = *to.add_numbers();
    w.set_name(number.name);
    w.set_unit(number.unit);
    w.set_minimum(number.minimum);
    w.set_maximum(number.maximum);
    w.set_needed(number.needed);
    w.set_usual(number.usual);
  }
}

void put(const ActiveFault& from, v1::ActiveFault& to) {
  to.set_part(from.part);
  to.set_kind(from.kind);
  put_numbers_of(from.numbers, to);
  to.set_until_tick(from.until_tick);
}

FaultKind kind_of(const v1::FaultKind& from) {
  FaultKind to{from.name(), from.target(), from.effect(), {}};
  for (const auto& w : from.numbers())
    to.numbers.push_back({w.name(), w.unit(), w.minimum(), w.maximum(), w.needed(), w.usual()});
  return to;
}

}  // namespace

void put(const InjectFault& from, v1::InjectFault& to) {
  to.set_part(from.part);
  to.set_kind(from.kind);
  put_numbers_of(from.numbers, to);
  to.set_duration_ns(from.duration_ns);
}

void take(const v1::InjectFault& from, InjectFault& to) {
  to = {from.part(), from.kind(), numbers_of(from), from.duration_ns()};
}

void put(const FaultList& from, v1::FaultList& to) {
  for (const auto& kind : from.kinds) put(kind, *to.add_kinds());
  for (const auto& fault : from.active) put(fault, *to.add_active());
}

void take(const v1::FaultList& from, FaultList& to) {
  for (const auto& w : from.kinds()) to.kinds.push_back(kind_of(w));
  for (const auto& w : from.active())
    to.active.push_back({w.part(), w.kind(), numbers_of(w), w.until_tick()});
}

}  // namespace visum::protocol::wire
