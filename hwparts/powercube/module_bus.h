// All modules of one part as a bus sees them: telegrams in, at most one answer each, and what they send
// unasked. The drives are the part's own, so that ports and bus command and show the same. Lives on the
// tick's thread. No allocation after construction.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "hwparts/drive/drive.h"
#include "hwparts/powercube/bus_faults.h"
#include "hwparts/powercube/module.h"
#include "hwparts/sensors/random.h"

namespace visum::powercube {

class ModuleBus {
 public:
  // A module for each of the drives. Throws ConfigError where the part's `modules:` is wrong.
  ModuleBus(const config::Node& part, std::span<const drive::DriveData> drives,
            std::span<const double> positions, bool homed, double tick_s);

  // The drive of module i, for all of them before anything else; it must stay where it is. Comes up as the
  // module's settings say.
  void bind(std::size_t i, drive::Drive& drive);

  // Between ticks. `telegram` as it came over `framing`.
  std::optional<Telegram> handle(const Telegram& telegram, BusFraming framing);
  // What happens to the answer that handle() gave last. Drawn there: chance follows from what the world took.
  const Passage& passage() const { return passage_; }
  // Cut: nothing is received and nothing sent.
  void connect(bool connected) { connected_ = connected; }
  bool connected() const { return connected_; }

  // The part's Execution Enable, from now on. The part saves it.
  void enable(bool enabled) { enabled_ = enabled; }
  // The ports stopped or homed the drives: what SYNC_MOTION kept back is no longer to be started.
  void drop_deferred();

  // What goes wrong from now on; {}: nothing. Chances are drawn anew from `seed`.
  void set_faults(const BusFaults& faults, std::uint64_t seed);

  // Once per tick, before the drives' act().
  void tick();
  // State frames of the last tick.
  std::span<const Telegram> spontaneous() const { return {spontaneous_.data(), spontaneous_count_}; }
  const Passage& spontaneous_passage(std::size_t i) const { return passages_[i]; }

  std::size_t size() const { return modules_.size(); }
  std::uint32_t state_word(std::size_t i) const { return powercube::state_word(view(modules_[i])); }
  const ModuleState& state(std::size_t i) const { return modules_[i].state; }

  // Back to the state after construction, once the drives are restarted.
  void restart();
  void save(hwparts::StateWriter& to) const;
  // What happens to the next telegrams, both ways: while a fault acts that is a matter of chance.
  void save_chance(hwparts::StateWriter& to) const;
  void load_chance(hwparts::StateReader& from);
  void load(hwparts::StateReader& from);

 private:
  struct Module {
    Settings settings;
    drive::Drive* drive = nullptr;
    ModuleState initial;
    ModuleState state;
  };
  ModuleEdit edit(Module& module) const {
    return {module.settings, module.drive->data(), *module.drive, module.state, enabled_};
  }
  ModuleView view(const Module& module) const {
    const drive::Drive& drive = *module.drive;
    return {module.settings, drive.data(), drive.state(), module.state, enabled_};
  }
  static void power_up(Module& module);

  Passage draw_passage();
  static bool happens(double share, sensors::Random& chance);

  double tick_s_;
  bool connected_ = true;
  bool enabled_ = true;
  BusFaults faults_;
  // One for each way.
  sensors::Random to_modules_{1, "to the modules"}, from_modules_{1, "from the modules"};
  std::vector<Module> modules_;
  Passage passage_;
  std::vector<Telegram> spontaneous_;
  std::vector<Passage> passages_;  // of spontaneous_
  std::size_t spontaneous_count_ = 0;
};

}  // namespace visum::powercube
