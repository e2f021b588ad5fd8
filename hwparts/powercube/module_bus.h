// All modules of one part as a bus sees them: a telegram comes in, at most one answer goes out, and modules
// may send state frames unasked. The drives belong to the part, so ports and bus command and show the same.
// The part owns the ModuleBus; it lives on the tick's thread. Nothing allocates after construction, and only
// construction can fail.
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
  // Makes a module for each of the drives. Throws ConfigError where the part's `modules:` is wrong.
  ModuleBus(const config::Node& part, std::span<const drive::DriveData> drives,
            std::span<const double> positions, bool homed, double tick_s);

  // Gives module i its drive, and brings the drive up as the module's settings say. Comes before all other
  // calls, for each module. The drive must outlive the bus and keep its address.
  void bind(std::size_t i, drive::Drive& drive);

  // Between ticks: carries out `telegram`, which came over `framing`, and returns its answer, if any.
  std::optional<Telegram> handle(const Telegram& telegram, BusFraming framing);
  // The faults that the last answer of handle() meets on its way. handle() draws them, so that chance depends
  // only on the telegrams that the world has taken, and a replay sees the same.
  const Passage& passage() const { return passage_; }
  // False cuts the bus: nothing is received and nothing sent.
  void connect(bool connected) { connected_ = connected; }
  bool connected() const { return connected_; }

  // The part's Execution Enable from now on. The part saves it, not the bus.
  void enable(bool enabled) { enabled_ = enabled; }
  // Drops the motions that SYNC_MOTION keeps back, since the ports have stopped or homed the drives.
  void drop_deferred();

  // The faults from now on; {}: none. Their chances are drawn anew from `seed`.
  void set_faults(const BusFaults& faults, std::uint64_t seed);

  // Once per tick, before the drives' act().
  void tick();
  // The state frames that modules sent in the last tick, and the faults that each meets on its way.
  std::span<const Telegram> spontaneous() const { return {spontaneous_.data(), spontaneous_count_}; }
  const Passage& spontaneous_passage(std::size_t i) const { return passages_[i]; }

  std::size_t size() const { return modules_.size(); }
  std::uint32_t state_word(std::size_t i) const { return powercube::state_word(view(modules_[i])); }
  const ModuleState& state(std::size_t i) const { return modules_[i].state; }

  // Back to the state after construction. The drives must have been restarted before.
  void restart();
  void save(hwparts::StateWriter& to) const;
  // The generators that decide the fate of the next telegrams, both ways. They are state only while a fault
  // acts by chance.
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
  // Tells the drive what it does not know of itself: whether its module comes up homed, and from where it
  // counts.
  static void power_up(Module& module);

  // Draws the faults that the next frame from a module meets.
  Passage draw_passage();
  static bool happens(double share, sensors::Random& chance);

  double tick_s_;
  bool connected_ = true;
  bool enabled_ = true;
  BusFaults faults_;
  // One generator for each direction.
  sensors::Random to_modules_{1, "to the modules"}, from_modules_{1, "from the modules"};
  std::vector<Module> modules_;
  Passage passage_;
  std::vector<Telegram> spontaneous_;
  std::vector<Passage> passages_;  // one for each of spontaneous_
  std::size_t spontaneous_count_ = 0;
};

}  // namespace visum::powercube
