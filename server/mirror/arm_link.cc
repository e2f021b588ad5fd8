#include "server/mirror/arm_link.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

namespace visum::mirror {
namespace {

using protocol::Connection;

// After that long without a word from the server, it is asked whether it still answers.
constexpr std::chrono::milliseconds kSilence{250};
constexpr std::chrono::seconds kBackSoon{3};
constexpr double kManyCounts = 1e15;      // only counters have such a range
constexpr std::int64_t kLostTicks = 100;  // an answer never takes that long
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

class OtherPart : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

std::optional<std::string> difference_of_ports(const std::vector<protocol::Port>& a,
                                               const std::vector<protocol::Port>& b) {
  if (a.size() != b.size())
    return "not the same number of ports: " + std::to_string(a.size()) + " and " + std::to_string(b.size());
  for (std::size_t i = 0; i < a.size(); ++i)
    if (a[i].name != b[i].name || a[i].unit != b[i].unit)
      return "port " + std::to_string(i) + " is not the same: '" + a[i].name + "' [" + a[i].unit + "] and '" +
             b[i].name + "' [" + b[i].unit + "]";
  return std::nullopt;
}

// True if the sample has a number for each port.
bool fits(const protocol::PartSample& sample, const protocol::PartDescription& part) {
  return sample.controller_inputs.size() == part.controller_inputs.size() &&
         sample.sensor_outputs.size() == part.sensor_outputs.size();
}

}  // namespace

bool is_counter(const protocol::Port& port) {
  return port.unit.empty() && port.maximum > kManyCounts;
}

std::optional<std::string> difference(const protocol::PartDescription& a,
                                      const protocol::PartDescription& b) {
  if (a.kind != b.kind) return "not of one kind: " + a.kind + " and " + b.kind;
  if (auto inputs = difference_of_ports(a.controller_inputs, b.controller_inputs)) return inputs;
  return difference_of_ports(a.sensor_outputs, b.sensor_outputs);
}

ArmLink::ArmLink(std::string address, std::string part, Entry entry)
    : address_(std::move(address)), part_(std::move(part)), entry_(std::move(entry)) {
  try {
    adopt(find(address_, part_, entry_, {}));
  } catch (const std::exception& error) {
    throw std::runtime_error(address_ + ": " + error.what());
  }
  ahead_.assign(description_.controller_inputs.size(), 0.0);
  sent_.assign(description_.controller_inputs.size(), kUnknown);
}

ArmLink::Found ArmLink::find(const std::string& address, const std::string& part, const Entry& entry,
                             const protocol::PartDescription& before) {
  const auto [host, port] = protocol::parse_address(address);
  Connection link(host, port, {1, 1, "visum-mirror", protocol::Role::kController, entry.token},
                  kConnectTimeout, entry.tls);
  auto description =
      link.request_as<protocol::PartDescriptionReply>(protocol::DescribePart{part}).description;
  if (const auto other = before.name.empty() ? std::nullopt : difference(before, description))
    throw OtherPart("the part '" + part + "' is another one than before: " + *other);
  link.request(protocol::AcquireLease{part});
  auto sample = link.request_as<protocol::PartSample>(protocol::Read{part});
  if (!fits(sample, description))
    throw OtherPart("the part '" + part + "' has not the ports that it tells of");
  link.request(protocol::Subscribe{part, 1});
  return {std::move(link), std::move(description), std::move(sample)};
}

void ArmLink::adopt(Found found) {
  sample_ = std::move(found.sample);
  simulated_ = found.connection.welcome().simulated;
  tick_ns_ = found.connection.welcome().tick_ns;
  description_ = std::move(found.description);
  for (std::size_t i = 0; i < sample_.controller_inputs.size(); ++i)
    description_.controller_inputs[i].initial = sample_.controller_inputs[i];
  for (std::size_t i = 0; i < sample_.sensor_outputs.size(); ++i)
    description_.sensor_outputs[i].initial = sample_.sensor_outputs[i];
  connection_ = std::move(found.connection);
  heard_at_ = Clock::now();
  probe_.reset();
  told_other_part_ = false;
}

bool ArmLink::poll() {
  if (!connected()) return look_again();
  try {
    while (auto reply = connection_->next(std::chrono::milliseconds(0))) {
      heard_at_ = Clock::now();
      if (auto* sample = std::get_if<protocol::PartSample>(&*reply)) {
        take(std::move(*sample));
      } else if (const auto* error = std::get_if<protocol::Error>(&*reply)) {
        ++refusals_;
        refusal_ = error->text;
        for (std::size_t i = 0; i < sent_.size(); ++i)
          if (!is_counter_at(i)) sent_[i] = kUnknown;
      } else if (const auto* event = std::get_if<protocol::Event>(&*reply);
                 event && event->kind == "lease_lost" && event->part == part_) {
        lose("its lease was lost: " + event->text);
        return false;
      }
    }
    check_answers();
  } catch (const std::exception& error) {
    lose(error.what());
    return false;
  }
  return connected() && put_back_;
}

// A world that is paused sends no samples, and neither does a server that hangs. But only the second one does
// not answer requests.
void ArmLink::check_answers() {
  const auto now = Clock::now();
  if (probe_) {
    bool answered = true;
    try {
      answered = connection_->wait_for(*probe_, std::chrono::milliseconds(0)).has_value();
    } catch (const protocol::RequestError&) {
      // a refusal is an answer
    }
    if (answered) {
      heard_at_ = now;
      probe_.reset();
    }
  }
  if (now - heard_at_ < kSilence) return;
  if (!probe_) {
    probe_ = connection_->send(protocol::Status{});
    probed_at_ = now;
  } else if (now - std::max(probed_at_, heard_at_) > kConnectTimeout) {
    lose("its server does not answer");
  }
}

// A sample shows a new era as soon as the event does. Counters that crossed the Reset on their way show in a
// later sample.
void ArmLink::take(protocol::PartSample sample) {
  if (!fits(sample, description_)) return;
  const bool other_era = sample.era != sample_.era;
  sample_ = std::move(sample);
  if (other_era || (!counted_at_ && !same_counters(sample_.controller_inputs, sent_))) put_back_ = true;
}

void ArmLink::lose(const std::string& why) {
  spdlog::error("{} is gone: {}", address_, why);
  drop();
  tried_ = Clock::now();
  left_at_ = {};
}

void ArmLink::lose_unless_refused(const std::exception& error) {
  const auto* refusal = dynamic_cast<const protocol::RequestError*>(&error);
  if (!refusal || refusal->code() == protocol::ErrorCode::kTimeout) lose(error.what());
}

bool ArmLink::look_again() {
  using namespace std::chrono_literals;
  if (!search_.valid()) {
    if (Clock::now() - tried_ < kRetryPeriod) return false;
    tried_ = Clock::now();
    search_ = std::async(std::launch::async, [closing = std::move(closing_), address = address_, part = part_,
                                              entry = entry_, before = description_] {
      if (closing.valid()) closing.wait();  // the old connection gives its lease back first
      return find(address, part, entry, before);
    });
  }
  if (search_.wait_for(0s) != std::future_status::ready) return false;
  try {
    adopt(search_.get());
  } catch (const OtherPart& error) {
    if (!std::exchange(told_other_part_, true)) spdlog::error("{} stays away: {}", address_, error.what());
    return false;
  } catch (const std::exception& error) {
    spdlog::debug("{}: {}", address_, error.what());
    return false;
  }
  spdlog::info("{} is there again", address_);
  return true;
}

// This happens at once, since the arm goes on with its last command until its lease is back.
void ArmLink::drop() {
  if (!connected()) return;
  closing_ = std::async(std::launch::async,
                        [left = std::exchange(connection_, std::nullopt)]() mutable { left.reset(); });
  tried_ = {};
  left_at_ = Clock::now();
}

bool ArmLink::comes_back() const {
  return !connected() && Clock::now() - left_at_ < kBackSoon;
}

void ArmLink::rebase(std::span<const double> inputs, std::span<const double> initial) {
  for (std::size_t i = 0; i < ahead_.size(); ++i) {
    sent_[i] = is_counter_at(i) ? sample_.controller_inputs[i] : kUnknown;
    if (is_counter_at(i)) ahead_[i] = sample_.controller_inputs[i] - inputs[i] + initial[i];
  }
  counted_at_.reset();
  put_back_ = false;
}

std::vector<double> ArmLink::as_the_arm_counts(std::span<const double> inputs,
                                               std::span<const double> initial) {
  std::vector<double> values(inputs.begin(), inputs.end());
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!is_counter_at(i)) continue;
    const auto& port = description_.controller_inputs[i];
    const auto count = [&] { return inputs[i] + (ahead_[i] - initial[i]); };
    if (count() < port.minimum || count() > port.maximum) {
      ahead_[i] += std::ceil(port.minimum - count());
      if (count() == sent_[i]) ahead_[i] += 1.0;  // else the arm would see no change
    }
    values[i] = count();
  }
  return values;
}

bool ArmLink::same_counters(std::span<const double> a, std::span<const double> b) const {
  for (std::size_t i = 0; i < a.size(); ++i)
    if (is_counter_at(i) && a[i] != b[i]) return false;
  return true;
}

// A counter that was sent, but is not in force after a while, is sent again with the next write.
void ArmLink::write(std::span<const double> inputs, std::span<const double> initial) {
  const auto values = as_the_arm_counts(inputs, initial);
  const bool is_lost = counted_at_ && sample_.tick > *counted_at_ + kLostTicks &&
                       !same_counters(values, sample_.controller_inputs);
  if (is_lost || !same_counters(values, sent_))
    send(0, values);
  else
    send_runs(values, false);
}

void ArmLink::write_counters(std::span<const double> inputs, std::span<const double> initial) {
  send_runs(as_the_arm_counts(inputs, initial), true);
}

void ArmLink::send_runs(std::span<const double> values, bool of_counters) {
  for (std::size_t first = 0, end = 0; first < values.size(); first = end) {
    end = first + 1;
    while (!is_counter_at(first) && end < values.size() && !is_counter_at(end)) ++end;
    const auto run = values.subspan(first, end - first);
    const auto known = std::span<const double>(sent_).subspan(first, end - first);
    if (is_counter_at(first) == of_counters && !std::ranges::equal(run, known)) send(first, run);
  }
}

void ArmLink::send(std::size_t first, std::span<const double> values) {
  if (!connected()) return;
  std::ranges::copy(values, sent_.begin() + static_cast<std::ptrdiff_t>(first));
  for (std::size_t i = first; i < first + values.size(); ++i)
    if (is_counter_at(i)) counted_at_ = sample_.tick;
  try {
    connection_->post(
        protocol::Write{part_, static_cast<std::uint32_t>(first), {values.begin(), values.end()}});
  } catch (const std::exception& error) {
    lose(error.what());
  }
}

bool ArmLink::has_parameter(const std::string& name) const {
  return std::ranges::any_of(description_.parameters, [&](const auto& known) { return known.name == name; });
}

std::vector<protocol::Parameter> ArmLink::parameters() {
  if (!connected()) return description_.parameters;
  try {
    return connection_->request_as<protocol::ParameterList>(protocol::GetParameters{part_}).parameters;
  } catch (const std::exception& error) {
    lose_unless_refused(error);
  }
  return description_.parameters;
}

std::optional<protocol::ParameterValue> ArmLink::parameter(const std::string& name) {
  for (const auto& known : parameters())
    if (known.name == name) return known.value;
  return std::nullopt;
}

std::optional<std::string> ArmLink::set_parameter(const std::string& name,
                                                  const protocol::ParameterValue& value) {
  ask_to_set(name, value);
  return answer();
}

void ArmLink::ask_to_set(const std::string& name, const protocol::ParameterValue& value) {
  asked_.reset();
  if (!connected()) return;
  try {
    asked_ = connection_->send(protocol::SetParameter{part_, name, value});
  } catch (const std::exception& error) {
    lose(error.what());
  }
}

std::optional<std::string> ArmLink::answer() {
  if (!connected() || !asked_) return address_ + " is gone";
  try {
    connection_->wait(*asked_);
    return std::nullopt;
  } catch (const std::exception& error) {
    lose_unless_refused(error);
    return address_ + ": " + error.what();
  }
}

std::vector<std::byte> ArmLink::read_blackboard(const std::string& name) {
  return connection_->request_as<protocol::BlackboardData>(protocol::ReadBlackboard{part_, name, 0, 0}).data;
}

}  // namespace visum::mirror
