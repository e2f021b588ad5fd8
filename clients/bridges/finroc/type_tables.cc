#include "clients/bridges/finroc/type_tables.h"

namespace visum::finroc {
namespace {

constexpr std::int16_t kDescriptionsFollow = -2, kEnd = -1, kNoInterval = -1, kUsualIntervalMs = 40;
constexpr std::uint8_t kStandardClass = 0, kCheapCopyClass = 1, kRpcClass = 2;
constexpr std::uint8_t kBinaryTrait = 1, kTextTrait = 2, kEnumTrait = 8;
constexpr std::size_t kMostTypes = 4096;

std::uint8_t class_of(Kind kind) {
  if (kind == Kind::kAdministration) return kRpcClass;
  return kind == Kind::kText ? kStandardClass : kCheapCopyClass;
}

std::uint8_t traits_of(Kind kind) {
  if (kind == Kind::kAdministration) return 0;
  const std::uint8_t traits = kBinaryTrait | kTextTrait;
  return kind == Kind::kChoice ? traits | kEnumTrait : traits;
}

}  // namespace

void TypesSent::put(Writer& out, const Type& type) {
  const bool first = numbers_.empty();
  const auto [row, is_new] = numbers_.try_emplace(type.name, static_cast<std::int16_t>(numbers_.size()));
  if (is_new) {
    out.put(kDescriptionsFollow);
    if (first) out.put(kUsualIntervalMs);
    out.put(row->second).put(kNoInterval).put(class_of(type.kind)).put_string(type.name);
    out.put(traits_of(type.kind));
    if (type.kind == Kind::kChoice) {
      out.put(static_cast<std::int16_t>(type.choices.size()));
      for (const std::string& choice : type.choices) out.put_string(choice);
    }
    out.put(kEnd);
  }
  out.put(row->second);
}

std::string TypesHeard::take(Reader& in) {
  auto number = in.take<std::int16_t>();
  if (number == kDescriptionsFollow) {
    take_descriptions(in);
    number = in.take<std::int16_t>();
  }
  const auto found = names_.find(number);
  return in.failed() || found == names_.end() ? std::string() : found->second;
}

void TypesHeard::take_descriptions(Reader& in) {
  if (!interval_seen_) in.take<std::int16_t>();
  interval_seen_ = true;
  while (!in.failed()) {
    const auto number = in.take<std::int16_t>();
    if (number == kEnd || in.failed()) return;
    in.take<std::int16_t>();  // its interval
    in.take<std::uint8_t>();  // its class
    std::string name = in.take_string();
    const auto traits = in.take<std::uint8_t>();
    if ((traits & kEnumTrait) != 0) {
      const auto count = in.take<std::int16_t>();
      for (int i = 0; i < count && !in.failed(); ++i) in.take_string();
    }
    if (number < 0 || names_.size() >= kMostTypes) in.fail();
    if (!in.failed()) names_[number] = std::move(name);
  }
}

}  // namespace visum::finroc
