#include "clients/mca/part.h"

#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cstdio>
#include <thread>

#include "clients/cpp/client_access.h"
#include "clients/mca/announce.h"
#include "clients/mca/door.h"
#include "clients/visum/common/exit_code.h"
#include "clients/visum/common/interrupt.h"
#include "protocol/codec.h"
#include "protocol/config/config.h"
#include "protocol/config/number_text.h"
#include "protocol/config/printable.h"
#include "protocol/limits.h"
#include "protocol/module_board.h"

namespace visum::mca {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr milliseconds kReportEvery{100};

bool fits_a_frame(const protocol::Request& request) {
  std::vector<std::byte> frame;
  protocol::encode_request(0, request, frame);
  return frame.size() <= protocol::Limits{}.max_frame;
}

struct Run {
  std::size_t from, to, count;
};

// The ports of `from` that have the name of a port of `to`. Neighbours that stay neighbours are one run.
std::vector<Run> runs_of_same_names(const Vector& from, const Vector& to) {
  std::vector<Run> runs;
  for (std::size_t i = 0; i < from.size(); ++i) {
    const auto same = std::ranges::find(to.names(), from.names()[i]);
    if (same == to.names().end()) continue;
    const auto at = static_cast<std::size_t>(same - to.names().begin());
    const bool goes_on = !runs.empty() && runs.back().from + runs.back().count == i &&
                         runs.back().to + runs.back().count == at;
    if (goes_on)
      ++runs.back().count;
    else
      runs.push_back({i, at, 1});
  }
  return runs;
}

}  // namespace

Part::Part(const std::string& name, PortNames names, std::int64_t period_ns)
    : Group(Place{nullptr, name}, std::move(names)) {
  options_.period_ns = period_ns;
}
Part::~Part() = default;

void Part::keep(Blackboard& board) {
  for (const Blackboard* other : blackboards_)
    if (other->name() == board.name())
      throw std::invalid_argument("'" + name() + "' has two blackboards '" + board.name() + "'");
  blackboards_.push_back(&board);
}

void Part::debug(const Module& module, int level, const std::string& domain, const std::string& text) const {
  const bool by_domain =
      level <= options_.debug_level && (options_.domains.empty() || options_.domains.contains(domain));
  if (!by_domain && !options_.modules.contains(module.path())) return;
  std::fprintf(stderr, "%.3f s %s [%s] %s\n", 1e-9 * static_cast<double>(loop_time_ns_),
               module.path().c_str(), domain.c_str(), text.c_str());
}

void Part::Connect(Lower& lower, std::size_t number) {
  for (const auto& [from, to, count] : runs_of_same_names(controller_output(), lower.controller_input()))
    lower.AddEdgeDown(controller_output(), from, to, count);
  if (number > 0) return;
  for (const auto& [from, to, count] : runs_of_same_names(lower.sensor_output(), sensor_input()))
    lower.AddEdgeUp(from, sensor_input(), to, count);
}

void Part::connect_lower_parts() {
  for (const auto& address : options_.lower) {
    auto& lower = lower_.emplace_back(std::make_unique<Lower>(address, name(), options_));
    Connect(*lower, lower_.size() - 1);
    if (lower->edges().empty())
      throw std::invalid_argument("no port of '" + name() + "' has the name of a port of '" +
                                  lower->part_name() + "'");
  }
}

void Part::check_version() const {
  if (options_.version_check.empty()) return;
  Client other(options_.version_check, {.name = name(), .role = Role::kObserver});
  const std::string& theirs = other.server().server;
  if (!theirs.ends_with(" " VISUM_VERSION))
    throw Error(ErrorCode::kVersion, "this is version " VISUM_VERSION ", but at " + options_.version_check +
                                         " there is '" + theirs + "'");
}

// ---------------------------------------- what others see

void Part::announce() {
  if (lower_.empty()) return;
  const std::string address = door_ ? "127.0.0.1:" + std::to_string(door_->port()) : "";
  auto announced = describe(*this, lower_, address);
  const auto wrong = protocol::ModuleBoard::check(announced);
  if (wrong || !fits_a_frame(announced) || !fits_a_frame(largest_values_of(*this))) {
    std::fprintf(stderr, "%s: the modules are not shown, but the part runs all the same: %s\n",
                 name().c_str(), wrong.value_or("too many modules, ports and parameters").c_str());
    announced.modules.resize(1);  // the address is found all the same
    announced.modules.front() = {{}, true};
    announced.edges.clear();
    announced.blackboards.clear();
    report_due_ = Clock::time_point::max();
  }
  ClientAccess::post(lower_.front()->client(), announced);
}

void Part::report() {
  if (lower_.empty() || Clock::now() < report_due_) return;
  report_due_ = Clock::now() + kReportEvery;
  ClientAccess::post(lower_.front()->client(), values_of(*this));
}

void Part::take_orders() {
  if (lower_.empty()) return;
  while (const auto message = ClientAccess::next(lower_.front()->client())) {
    if (const auto* hold = std::get_if<protocol::OverrideModulePort>(&*message)) take_order(*hold);
    if (const auto* setting = std::get_if<protocol::SetModuleParameter>(&*message)) take_order(*setting);
  }
}

template <typename Order>
void Part::take_order(const Order& wanted) {
  if (wanted.part == name())
    apply(wanted);
  else if (door_)
    door_->pass_up(wanted);
}

void Part::apply(const protocol::SetModuleParameter& wanted) {
  Module* module = find_module(*this, wanted.path);
  if (module == nullptr) return;
  const auto& parameters = module->parameters();
  const auto parameter = std::ranges::find(parameters, wanted.name, [](auto* one) { return one->name(); });
  if (parameter == parameters.end()) return;
  const std::string why = (*parameter)->set(wanted.value);
  const std::string news =
      why.empty()
          ? wanted.name + " is " + config::printable(protocol::value_text((*parameter)->value())) + " now"
          : "refuses a value: " + why;
  std::fprintf(stderr, "%s: '%s' %s\n", name().c_str(), wanted.path.c_str(), news.c_str());
  report_due_ = {};
}

void Part::apply(const protocol::OverrideModulePort& wanted) {
  Module* module = find_module(*this, wanted.path);
  if (module == nullptr) return;
  Vector& inputs = module->sensor_input();
  const auto port = std::ranges::find(inputs.names(), wanted.port);
  if (port == inputs.names().end()) return;
  const auto index = static_cast<std::size_t>(port - inputs.names().begin());
  const std::string what = name() + ": '" + wanted.path + "' Sensor Input '" + wanted.port + "' ";
  if (wanted.release) {
    inputs.release(index);
    std::fprintf(stderr, "%sfollows its edge again\n", what.c_str());
  } else {
    inputs.hold(index, wanted.value);
    std::fprintf(stderr, "%sholds %s for a test\n", what.c_str(), config::number_text(wanted.value).c_str());
  }
  report_due_ = {};
}

// ---------------------------------------- the loop

// The first of the parts below gives the time. Others that are in lockstep must be waited for, too; all
// others go on by themselves.
void Part::wait_for_next_cycle() {
  const auto length_ns =
      static_cast<std::int64_t>(options_.time_scale * static_cast<double>(options_.period_ns));
  std::vector<Lower*> awaited;
  for (const auto& lower : lower_) {
    if (lower != lower_.front() && !lower->in_lockstep()) {
      lower->read();
      continue;
    }
    lower->begin_advance(length_ns);
    awaited.push_back(lower.get());
  }
  for (Lower* lower : awaited) {
    while (!lower->advanced(milliseconds(1)))
      if (door_) door_->serve(std::chrono::nanoseconds(0));
  }
  if (!lower_.empty()) return;
  due_ = std::max(due_ + std::chrono::nanoseconds(length_ns), Clock::now());
  while (Clock::now() < due_) {
    if (door_)
      door_->serve(std::min<std::chrono::nanoseconds>(due_ - Clock::now(), milliseconds(10)));
    else
      std::this_thread::sleep_until(due_);
  }
}

// Returns false once the part is to end.
bool Part::cycle() {
  for (const auto& lower : lower_) lower->sense();
  run_sense();
  if (door_) {
    door_->publish(loop_time_ns_ / options_.period_ns, loop_time_ns_);
    door_->serve(std::chrono::nanoseconds(0));
    while (in_lockstep() && !door_->is_left() && !door_->is_complete()) {
      if (cli::interrupted()) return false;
      door_->serve(milliseconds(1));
    }
    if (in_lockstep() && door_->is_left()) return false;
    door_->take_commands();
  }
  run_control();
  for (const auto& lower : lower_) lower->control();
  take_orders();
  report();
  if (ended_ || cli::interrupted()) return false;
  wait_for_next_cycle();
  loop_time_ns_ += options_.period_ns;
  return true;
}

void Part::loop() {
  due_ = Clock::now();
  while (cycle()) {
  }
  for (const auto& lower : lower_) lower->release();
  if (door_) door_->close();
}

int Part::run(const Options& options) {
  const std::int64_t own_period_ns = options_.period_ns;
  options_ = options;
  if (options_.period_ns == 0) options_.period_ns = own_period_ns;
  spdlog::set_default_logger(spdlog::stderr_logger_mt(name()));
  try {
    if (!options_.config_file.empty()) apply_config_file(options_.config_file, *this);
    std::vector<std::string> complaints;
    sort(complaints);
    for (const auto& complaint : complaints)
      std::fprintf(stderr, "%s: %s\n", name().c_str(), complaint.c_str());
    check_version();
    connect_lower_parts();
    const bool simulated = lower_.empty() || lower_.front()->simulated();
    if (options_.port >= 0)
      door_ = std::make_unique<Door>(*this, options_.port, in_lockstep(), simulated,
                                     Door::Hooks{[this](const protocol::Request& request) {
                                       if (!lower_.empty())
                                         ClientAccess::post(lower_.front()->client(), request);
                                     }});
    if (door_) std::printf("%s serves its ports at 127.0.0.1:%d\n", name().c_str(), door_->port());
    std::fflush(stdout);
    announce();
    loop();
  } catch (...) {
    for (const auto& lower : lower_) lower->drop();
    throw;
  }
  return cli::interrupted() && !ended_ ? cli::kInterrupted : cli::kDone;
}

int run(const MakePart& make, const std::string& name, const std::string& about, int argc,
        const char* const* argv) {
  Options options{.name = name};
  if (const auto code = parse(about, argc, argv, options)) return *code;
  const auto complain = [&](int code, const char* text) {
    std::fprintf(stderr, "%s: %s\n", options.name.c_str(), text);
    return code;
  };
  cli::catch_interrupts();
  try {
    return make(options.name)->run(options);
  } catch (const config::ConfigError& error) {
    return complain(cli::kBadConfig, error.what());
  } catch (const UpperLost& error) {
    return complain(cli::kLost, error.what());
  } catch (const Error& error) {
    const bool usage = error.code() == ErrorCode::kMisuse;
    const bool lost = error.code() == ErrorCode::kConnection || error.code() == ErrorCode::kTimeout;
    return complain(usage ? cli::kUsage : lost ? cli::kLost : cli::kFailed, error.what());
  } catch (const std::exception& error) {
    return complain(cli::kFailed, error.what());
  }
}

}  // namespace visum::mca
