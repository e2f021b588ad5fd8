#include "clients/mca/lower.h"

#include <algorithm>
#include <stdexcept>
#include <thread>

#include "clients/cpp/client_access.h"
#include "clients/mca/options.h"
#include "protocol/module_messages.h"

namespace visum::mca {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

milliseconds in_ms(double seconds) {
  return std::chrono::duration_cast<milliseconds>(std::chrono::duration<double>(seconds));
}

std::vector<std::string> names_of(const std::vector<PortInfo>& ports) {
  std::vector<std::string> names;
  for (const PortInfo& port : ports) names.push_back(port.name);
  return names;
}

// Where a part of the controller serves its ports, as it has announced it; empty: not known yet.
std::string announced_address(Client& server, const std::string& part) {
  try {
    const auto list =
        std::get<protocol::ModuleList>(ClientAccess::request(server, protocol::ListModules{part}));
    return list.parts.empty() ? std::string() : list.parts.front().announced.address;
  } catch (const Error& error) {
    if (error.code() == ErrorCode::kUnknownName) return {};
    throw;
  }
}

// Asks the server where the part is, until it knows.
std::string find(const std::string& part, const std::string& server, const std::string& client_name,
                 const Options& options) {
  const auto give_up = Clock::now() + in_ms(options.connect_timeout_s);
  Client client(server, {.name = client_name,
                         .role = Role::kObserver,
                         .token_file = options.token_file,
                         .connect_timeout = in_ms(options.connect_timeout_s)});
  for (;;) {
    const auto names = client.part_names();
    if (std::ranges::find(names, part) != names.end()) return server;
    if (const auto address = announced_address(client, part); !address.empty()) return address;
    if (Clock::now() > give_up)
      throw Error(ErrorCode::kUnknownName, "the server at " + server + " has no part '" + part +
                                               "', and no part of a controller announces that name");
    std::this_thread::sleep_for(milliseconds(10));
  }
}

}  // namespace

Lower::Lower(const std::string& address, const std::string& client_name, const Options& options) {
  const auto at = address.find('@');
  if (at == std::string::npos || at == 0 || at + 1 == address.size())
    throw Error(ErrorCode::kMisuse, "'" + address + "' is no PART@HOST:PORT");
  const std::string part = address.substr(0, at);
  connect(part, find(part, address.substr(at + 1), client_name, options), client_name, options);
}

void Lower::connect(const std::string& part, const std::string& address, const std::string& client_name,
                    const Options& options) {
  client_ =
      std::make_unique<Client>(address, ClientOptions{.name = client_name,
                                                      .token_file = options.token_file,
                                                      .connect_timeout = in_ms(options.connect_timeout_s)});
  part_ = std::make_unique<visum::Part>(client_->part(part));
  controller_input_ =
      std::make_unique<Vector>(VectorKind::kControllerInput, nullptr, names_of(part_->input_ports()));
  sensor_output_ =
      std::make_unique<Vector>(VectorKind::kSensorOutput, nullptr, names_of(part_->output_ports()));
  commanded_.assign(controller_input_->size(), false);
  part_->acquire();
  client_->join();
}

void Lower::AddEdgeDown(Vector& from, std::size_t first_from, std::size_t first_to, std::size_t count) {
  if (from.kind() != VectorKind::kControllerOutput || first_from > from.size() ||
      count > from.size() - first_from || first_to > controller_input_->size() ||
      count > controller_input_->size() - first_to)
    throw std::invalid_argument("an edge down to '" + part_name() +
                                "' must go from a controller output, and stay within both vectors");
  edges_.push_back({&from, first_from, controller_input_.get(), first_to, count});
  for (std::size_t i = 0; i < count; ++i) commanded_[first_to + i] = true;
}

void Lower::AddEdgeUp(std::size_t first_from, Vector& to, std::size_t first_to, std::size_t count) {
  if (to.kind() != VectorKind::kSensorInput || first_to > to.size() || count > to.size() - first_to ||
      first_from > sensor_output_->size() || count > sensor_output_->size() - first_from)
    throw std::invalid_argument("an edge up from '" + part_name() +
                                "' must go to a sensor input, and stay within both vectors");
  edges_.push_back({sensor_output_.get(), first_from, &to, first_to, count});
}

void Lower::sense() {
  const auto values = part_->all_outputs().values();
  for (std::size_t i = 0; i < values.size(); ++i) sensor_output_->at(i) = values[i];
  for (const Edge& edge : edges_)
    if (edge.from == sensor_output_.get()) edge.carry();
}

void Lower::control() {
  for (const Edge& edge : edges_)
    if (edge.from != sensor_output_.get()) edge.carry();
  if (!controller_input_->changed()) return;
  auto inputs = part_->all_inputs();
  for (std::size_t i = 0; i < commanded_.size(); ++i)
    if (commanded_[i] && controller_input_->changed(i)) inputs.set(i, controller_input_->at(i));
  controller_input_->look();
  part_->write();
}

void Lower::release() {
  part_->release();
  client_->leave();
}

void Lower::drop() noexcept {
  ClientAccess::drop(*client_);
}

}  // namespace visum::mca
