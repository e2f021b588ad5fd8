#include "server/gateway/mirror/arm_link.h"

#include <spdlog/spdlog.h>

#include <stdexcept>
#include <utility>

namespace visum::gateway {
namespace {

using protocol::Connection;

constexpr std::chrono::milliseconds kConnect{1000};
constexpr std::chrono::seconds kLookAgain{1};
constexpr double kManyCounts = 1e15;  // only counters reach so far

}  // namespace

bool is_counter(const protocol::Port& port) {
  return port.unit.empty() && port.maximum > kManyCounts;
}

ArmLink::ArmLink(std::string address, std::string part, Entry entry)
    : address_(std::move(address)), part_(std::move(part)), entry_(std::move(entry)) {
  try {
    adopt(find(address_, part_, entry_));
  } catch (const std::exception& error) {
    throw std::runtime_error(address_ + ": " + error.what());
  }
  ahead_.assign(description_.controller_inputs.size(), 0.0);
}

ArmLink::Found ArmLink::find(const std::string& address, const std::string& part, const Entry& entry) {
  const auto [host, port] = protocol::parse_address(address);
  Connection link(host, port, {1, 1, "visum-mirror", protocol::Role::kController, entry.token}, kConnect,
                  entry.tls);
  auto description =
      link.request_as<protocol::PartDescriptionReply>(protocol::DescribePart{part}).description;
  link.request(protocol::AcquireLease{part});
  auto sample = link.request_as<protocol::PartSample>(protocol::Read{part});
  link.request(protocol::Subscribe{part, 1});
  return {std::move(link), std::move(description), std::move(sample)};
}

// Throws std::runtime_error where the part is another one than before.
void ArmLink::adopt(Found found) {
  const bool first = description_.name.empty();
  if (!first && found.description.controller_inputs.size() != description_.controller_inputs.size())
    throw std::runtime_error("the part '" + part_ + "' has other ports than before");
  sample_ = std::move(found.sample);
  simulated_ = found.connection.welcome().simulated;
  tick_ns_ = found.connection.welcome().tick_ns;
  description_ = std::move(found.description);
  for (std::size_t i = 0; i < sample_.controller_inputs.size(); ++i)
    description_.controller_inputs[i].initial = sample_.controller_inputs[i];
  for (std::size_t i = 0; i < sample_.sensor_outputs.size(); ++i)
    description_.sensor_outputs[i].initial = sample_.sensor_outputs[i];
  connection_ = std::move(found.connection);
}

bool ArmLink::poll() {
  if (!connected()) return look_again();
  try {
    while (auto reply = connection_->next(std::chrono::milliseconds(0))) {
      if (auto* sample = std::get_if<protocol::PartSample>(&*reply)) {
        sample_ = std::move(*sample);
      } else if (const auto* error = std::get_if<protocol::Error>(&*reply)) {
        ++refusals_;
        refusal_ = error->text;
      } else if (const auto* event = std::get_if<protocol::Event>(&*reply);
                 event && event->kind == "lease_lost" && event->part == part_) {
        lose("its lease was lost: " + event->text);
        return false;
      }
    }
  } catch (const std::exception& error) {
    lose(error.what());
  }
  return false;
}

void ArmLink::lose(const std::string& why) {
  spdlog::error("{} is gone: {}", address_, why);
  drop();
  tried_ = Clock::now();
}

bool ArmLink::look_again() {
  using namespace std::chrono_literals;
  if (!search_.valid()) {
    if (Clock::now() - tried_ < kLookAgain) return false;
    tried_ = Clock::now();
    search_ = std::async(std::launch::async, [left = std::exchange(left_, std::nullopt), address = address_,
                                              part = part_, entry = entry_]() mutable {
      left.reset();  // first gives its lease back
      return find(address, part, entry);
    });
  }
  if (search_.wait_for(0s) != std::future_status::ready) return false;
  try {
    adopt(search_.get());
  } catch (const std::exception& error) {
    spdlog::debug("{}: {}", address_, error.what());
    return false;
  }
  spdlog::info("{} is there again", address_);
  return true;
}

void ArmLink::drop() {
  left_ = std::exchange(connection_, std::nullopt);
  tried_ = {};
}

void ArmLink::rebase(std::span<const double> inputs, std::span<const double> initial) {
  for (std::size_t i = 0; i < ahead_.size(); ++i) {
    if (!is_counter(description_.controller_inputs[i])) continue;
    ahead_[i] = sample_.controller_inputs[i] - inputs[i] + initial[i];
  }
}

double ArmLink::as_the_arm_counts(std::size_t port, double value, double initial) const {
  return is_counter(description_.controller_inputs[port]) ? value + ahead_[port] - initial : value;
}

void ArmLink::write(std::span<const double> inputs, std::span<const double> initial) {
  std::vector<double> values(inputs.size());
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = as_the_arm_counts(i, inputs[i], initial[i]);
  send(std::move(values));
}

void ArmLink::write_counters(std::span<const double> inputs, std::span<const double> initial) {
  auto values = sample_.controller_inputs;
  for (std::size_t i = 0; i < values.size(); ++i)
    if (is_counter(description_.controller_inputs[i]))
      values[i] = as_the_arm_counts(i, inputs[i], initial[i]);
  send(std::move(values));
}

void ArmLink::send(std::vector<double> values) {
  if (!connected()) return;
  try {
    connection_->post(protocol::Write{part_, 0, std::move(values)});
  } catch (const std::exception& error) {
    lose(error.what());
  }
}

std::vector<protocol::Parameter> ArmLink::parameters() {
  if (!connected()) return description_.parameters;
  try {
    return connection_->request_as<protocol::ParameterList>(protocol::GetParameters{part_}).parameters;
  } catch (const std::exception& error) {
    lose(error.what());
  }
  return description_.parameters;
}

std::optional<std::string> ArmLink::set_parameter(const std::string& name,
                                                  const protocol::ParameterValue& value) {
  if (!connected()) return address_ + " is gone";
  try {
    connection_->request(protocol::SetParameter{part_, name, value});
    return std::nullopt;
  } catch (const std::exception& error) {
    const auto* refusal = dynamic_cast<const protocol::RequestError*>(&error);
    if (!refusal || refusal->code() == protocol::ErrorCode::kTimeout) lose(error.what());
    return address_ + ": " + error.what();
  }
}

std::vector<std::byte> ArmLink::read_blackboard(const std::string& name) {
  return connection_->request_as<protocol::BlackboardData>(protocol::ReadBlackboard{part_, name, 0, 0}).data;
}

}  // namespace visum::gateway
