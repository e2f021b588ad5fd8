#include "clients/bridges/common/plant.h"

#include "protocol/part_description.h"

namespace visum::bridge {
namespace {

// Returns why the server refused. Only a lost connection is no refusal.
std::string refusal_of(const std::function<void()>& command) try {
  command();
  return {};
} catch (const Error& error) {
  if (error.code() == ErrorCode::kConnection) throw;
  return error.what();
}

}  // namespace

Plant::Plant(const std::string& address, const ClientOptions& options) : client_(address, options) {
  for (const std::string& name : client_.part_names()) parts_.push_back(client_.part(name));
}

std::vector<std::string> Plant::names() const {
  std::vector<std::string> names;
  for (const Part& part : parts_) names.push_back(part.name());
  return names;
}

void Plant::refresh() {
  for (Part& part : parts_) part.read();
}

std::string Plant::under_lease(std::size_t part, const std::function<void(Part&)>& command) {
  Part& target = parts_.at(part);
  return refusal_of([&] {
    target.acquire();
    const std::string refusal = refusal_of([&] { command(target); });
    target.release();  // throws what was refused of a write
    if (!refusal.empty()) throw Error(ErrorCode::kBadValue, refusal);
  });
}

std::string Plant::check_input(std::size_t part, std::size_t port, double value) const {
  return refusal_of([&] { parts_.at(part).input(port).check(0, value); });
}

std::string Plant::set_input(std::size_t part, std::size_t port, double value) {
  return under_lease(part, [&](Part& target) {
    target.input(port).set(value);
    target.write();
  });
}

std::string Plant::set_parameter(std::size_t part, const std::string& name, const ParameterValue& value) {
  if (name == protocol::kEmergencyStop && value == ParameterValue(true)) {  // anybody may stop, at any time
    return refusal_of([&] { parts_.at(part).set_parameter(name, value); });
  }
  return under_lease(part, [&](Part& target) { target.set_parameter(name, value); });
}

std::string Plant::write_blackboard(std::size_t part, const std::string& name,
                                    std::span<const std::byte> data) {
  return under_lease(part, [&](Part& target) { target.write_blackboard(name, data); });
}

}  // namespace visum::bridge
