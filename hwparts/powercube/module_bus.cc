#include "hwparts/powercube/module_bus.h"

namespace visum::powercube {

ModuleBus::ModuleBus(const config::Node& part, std::span<const drive::DriveData> drives,
                     std::span<const double> positions, bool homed, double tick_s)
    : tick_s_(tick_s) {
  std::vector<int> ids;
  for (std::size_t i = 0; i < drives.size(); ++i) {
    ids.push_back(drives[i].module);
    auto& module = modules_.emplace_back();
    module.settings = read_settings(part, drives[i], homed);
    module.initial = initial_state(module.settings, drives[i], positions[i]);
    module.state = module.initial;
  }
  check_exceptions(part, ids);
  spontaneous_.resize(modules_.size());
  passages_.resize(modules_.size());
}

void ModuleBus::bind(std::size_t i, drive::Drive& drive) {
  modules_[i].drive = &drive;
  power_up(modules_[i]);
}

void ModuleBus::power_up(Module& module) {
  auto& drive = *module.drive;
  const auto& settings = module.settings;
  drive.set_homed(settings.homed);
  drive.set_zero_after_home((settings.config & config_bit::kZeroMoveAfterHome) != 0);
  if (!settings.homed && settings.counts_from_zero) drive.count_from_here();
}

std::optional<Telegram> ModuleBus::handle(const Telegram& telegram, BusFraming framing) {
  if (!connected_ || from_module(telegram.kind) || happens(faults_.lost, to_modules_)) return std::nullopt;
  if (telegram.kind == Telegram::Kind::kBroadcast) {
    for (auto& module : modules_) execute_broadcast(edit(module), telegram.message, framing);
    return std::nullopt;
  }
  // On CAN the frame's id says whether the telegram reads or writes. Id and command must agree.
  const bool reads = telegram.message.command() == command::kGetParameter;
  if (framing == BusFraming::kCan && reads != (telegram.kind == Telegram::Kind::kGet)) return std::nullopt;
  for (auto& module : modules_) {
    if (module.state.address != telegram.module) continue;
    const auto answer = powercube::execute(edit(module), telegram.message, framing);
    if (!answer) return std::nullopt;
    passage_ = draw_passage();
    return Telegram{Telegram::Kind::kAnswer, telegram.module, *answer};
  }
  return std::nullopt;
}

void ModuleBus::set_faults(const BusFaults& faults, std::uint64_t seed) {
  if (faults == faults_) return;
  faults_ = faults;
  to_modules_ = sensors::Random(seed, "to the modules");
  from_modules_ = sensors::Random(seed, "from the modules");
}

void ModuleBus::drop_deferred() {
  for (auto& module : modules_) module.state.deferred = false;
}

bool ModuleBus::happens(double share, sensors::Random& chance) {
  return share > 0.0 && chance.uniform() < share;
}

Passage ModuleBus::draw_passage() {
  auto& chance = from_modules_;
  return {happens(faults_.lost, chance), happens(faults_.doubled, chance), happens(faults_.corrupted, chance),
          faults_.late_ns};
}

void ModuleBus::tick() {
  spontaneous_count_ = 0;
  for (auto& module : modules_) {
    const auto whole = edit(module);
    powercube::tick(whole, tick_s_);
    const auto state = spontaneous_state(whole, tick_s_);
    if (!state || !connected_) continue;
    passages_[spontaneous_count_] = draw_passage();
    spontaneous_[spontaneous_count_++] = {Telegram::Kind::kState, module.state.address, *state};
  }
}

void ModuleBus::restart() {
  connected_ = true;
  spontaneous_count_ = 0;
  for (auto& module : modules_) {
    module.state = module.initial;
    power_up(module);
  }
}

void ModuleBus::save(hwparts::StateWriter& to) const {
  to.put(connected_);
  for (const auto& module : modules_) powercube::save(module.state, to);
}

void ModuleBus::load(hwparts::StateReader& from) {
  from.get(connected_);
  for (auto& module : modules_) powercube::load(module.state, from);
  spontaneous_count_ = 0;
}

void ModuleBus::save_chance(hwparts::StateWriter& to) const {
  if (!faults_.by_chance()) return;
  to_modules_.save(to);
  from_modules_.save(to);
}

void ModuleBus::load_chance(hwparts::StateReader& from) {
  if (!faults_.by_chance()) return;
  to_modules_.load(from);
  from_modules_.load(from);
}

}  // namespace visum::powercube
