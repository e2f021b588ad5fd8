// Threads that solve islands (islands.h) side by side. An island's answer depends on nothing but itself, so
// any number of threads gives the same bits.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <thread>
#include <vector>

namespace visum::dynamics::impulse {

// Ends a tick in which an island that several threads solved has failed, or has met the limit of work. The
// engine makes the tick anew with one thread, which then fails as it always does, and leaves the same bits.
struct NeedsOneThread {};

// The tick's thread and `threads` - 1 others. Plant owns it. The tick's thread calls; the others sleep
// between calls. Work is handed over by atomics, without allocation.
class IslandPool {
 public:
  explicit IslandPool(int threads);  // throws std::system_error where the system refuses a thread
  ~IslandPool();
  IslandPool(const IslandPool&) = delete;
  IslandPool& operator=(const IslandPool&) = delete;

  std::size_t threads() const { return others_.size() + 1; }
  // Calls work(worker, i) once for each i below `count`, and returns when all are done. `worker` is below
  // threads(), 0 the calling thread; calls of one worker come one after the other. `work` must not throw.
  template <typename Work>
  void run(std::size_t count, Work& work) {
    work_ = &work;
    call_ = [](void* what, std::size_t worker, std::size_t i) { (*static_cast<Work*>(what))(worker, i); };
    run_all(count);
  }

 private:
  void run_all(std::size_t count);
  void take_turns(std::size_t worker);  // calls until no index is left
  void serve(std::size_t worker);       // a thread's whole life
  void end();

  // The present work: run_all() writes it before round_ grows, and the others read it after.
  void* work_ = nullptr;
  void (*call_)(void*, std::size_t, std::size_t) = nullptr;
  std::size_t count_ = 0;
  bool ending_ = false;
  alignas(64) std::atomic<std::size_t> next_{0};     // the first index that nobody has taken
  alignas(64) std::atomic<std::uint32_t> round_{0};  // grows with each run
  alignas(64) std::atomic<std::uint32_t> busy_{0};   // threads that have not finished the round
  std::vector<std::thread> others_;
};

}  // namespace visum::dynamics::impulse
