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

ArmLink::ArmLink(std::string address, std::string part, std::string token)
    : address_(std::move(address)), part_(std::move(part)), token_(std::move(token)) {
  try {
    connect();
  } catch (const std::exception& error) {
    throw std::runtime_error(address_ + ": " + error.what());
  }
  ahead_.assign(description_.controller_inputs.size(), 0.0);
}

void ArmLink::connect() {
  const auto [host, port] = protocol::parse_address(address_);
  Connection link(host, port, {1, 1, "visum-mirror", protocol::Role::kController, token_}, kConnect);
  auto description =
      link.request_as<protocol::PartDescriptionReply>(protocol::DescribePart{part_}).description;
  if (!description_.name.empty() &&
      description.controller_inputs.size() != description_.controller_inputs.size())
    throw std::runtime_error("the part '" + part_ + "' has other ports than before");
  link.request(protocol::AcquireLease{part_});
  sample_ = link.request_as<protocol::PartSample>(protocol::Read{part_});
  link.request(protocol::Subscribe{part_, 1});
  simulated_ = link.welcome().simulated;
  tick_ns_ = link.welcome().tick_ns;
  description_ = std::move(description);
  for (std::size_t i = 0; i < sample_.controller_inputs.size(); ++i)
    description_.controller_inputs[i].initial = sample_.controller_inputs[i];
  for (std::size_t i = 0; i < sample_.sensor_outputs.size(); ++i)
    description_.sensor_outputs[i].initial = sample_.sensor_outputs[i];
  connection_ = std::move(link);
}

bool ArmLink::poll() {
  if (!connected()) return look_again();
  try {
    while (auto reply = connection_->next(std::chrono::milliseconds(0))) {
      if (auto* sample = std::get_if<protocol::PartSample>(&*reply)) {
        sample_ = std::move(*sample);
      } else if (const auto* error = std::get_if<protocol::Error>(&*reply)) {
        spdlog::error("{} refuses: {}", address_, error->text);
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
  if (Clock::now() - tried_ < kLookAgain) return false;
  tried_ = Clock::now();
  try {
    connect();
  } catch (const std::exception& error) {
    spdlog::debug("{}: {}", address_, error.what());
    return false;
  }
  spdlog::info("{} is there again", address_);
  return true;
}

void ArmLink::drop() {
  connection_.reset();
  tried_ = {};
}

void ArmLink::rebase(std::span<const double> inputs, std::span<const double> initial) {
  for (std::size_t i = 0; i < ahead_.size(); ++i) {
    if (!is_counter(description_.controller_inputs[i])) continue;
    ahead_[i] = sample_.controller_inputs[i] - inputs[i] + initial[i];
  }
}

void ArmLink::write(std::span<const double> inputs, std::span<const double> initial) {
  if (!connected()) return;
  std::vector<double> values(inputs.begin(), inputs.end());
  for (std::size_t i = 0; i < values.size(); ++i)
    if (is_counter(description_.controller_inputs[i])) values[i] += ahead_[i] - initial[i];
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
  } catch (const protocol::RequestError& error) {
    spdlog::error("{}: {}", address_, error.what());
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
  } catch (const protocol::RequestError& error) {
    return address_ + ": " + error.what();
  } catch (const std::exception& error) {
    lose(error.what());
    return address_ + ": " + error.what();
  }
}

std::vector<std::byte> ArmLink::read_blackboard(const std::string& name) {
  return connection_->request_as<protocol::BlackboardData>(protocol::ReadBlackboard{part_, name, 0, 0}).data;
}

}  // namespace visum::gateway
