// Carries out AddBody and RemoveBody, one after the other, in the order in which they came. A thread of its
// own makes each change ready (cycle/body_change.h), so that neither the tick nor the sessions wait for the
// reading of a body. The tick's side takes it between two ticks.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <semaphore>
#include <thread>
#include <utility>
#include <vector>

#include "server/cycle/simulation.h"
#include "server/gateway/mailbox.h"

namespace visum::gateway {

// Owned by the TickSide; all public functions are for the tick's thread, and none of them waits but end(),
// which lets the thread finish the change that it is at.
class BodyChanges {
 public:
  static constexpr std::size_t kMost = 4;  // under way at once

  explicit BodyChanges(cycle::Simulation& simulation) : simulation_(simulation) { commands_.reserve(kMost); }
  ~BodyChanges() { end(); }

  // `wake` is called on the thread when a change is ready. Before the first command.
  void on_ready(std::function<void()> wake) { wake_ = std::move(wake); }

  // Ends the thread; nothing may be begun afterwards.
  void end();

  bool full() const { return commands_.size() == kMost; }
  // Takes a command with an AddBody or a RemoveBody. Only where it is not full.
  void begin(std::unique_ptr<Command> command);
  bool under_way() const { return !commands_.empty(); }
  bool ready() const { return ready_.load(std::memory_order_acquire); }
  struct Finished {
    std::unique_ptr<Command> command;  // with the world's new description, where the change was done
    cycle::Outcome outcome;
  };
  // Only where it is ready: carries out the change, and begins the next one.
  Finished finish();

 private:
  struct Job {
    cycle::BodyChange change;
    cycle::Outcome outcome;
    std::uint64_t revision = 0;       // of the changed world
    std::unique_ptr<WorldView> view;  // of the changed world
  };

  // Hands the first of the commands to the thread. Where there is no memory or no thread for it, it is ready
  // at once, refused.
  void start();
  void start_thread();
  void run();

  cycle::Simulation& simulation_;
  std::function<void()> wake_ = [] {};
  std::vector<std::unique_ptr<Command>> commands_;  // in their order; the first one is being made ready
  Job job_;                                         // the thread's from start() until it is ready
  std::atomic<bool> ready_{false}, ending_{false};
  std::binary_semaphore wanted_{0};
  std::thread thread_;  // started with the first command
};

}  // namespace visum::gateway
