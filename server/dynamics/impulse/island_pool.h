// Threads that solve islands (islands.h) side by side. An island's answer depends on nothing but itself, so
// any number of threads gives the same bits.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <thread>
#include <vector>

namespace visum::dynamics::impulse {

// Ends a tick that has met the limit of work while several threads stepped. The engine makes it anew with one
// thread, which then meets the limit where it always does, and leaves the same bits.
struct NeedsOneThread {};

// The tick's thread and `threads` - 1 others. Plant owns it. The tick's thread calls. Whoever waits, for the
// next call or for the others, looks again for some 20 us, then sleeps. Work is handed over by atomics,
// without allocation. Each thread begins with a share of its own, in order: islands that keep their places
// then stay in the cache of one processor. A thread that has done its share helps the others, from their
// ends.
class IslandPool {
 public:
  explicit IslandPool(int threads);  // throws std::system_error where the system refuses a thread
  ~IslandPool();
  IslandPool(const IslandPool&) = delete;
  IslandPool& operator=(const IslandPool&) = delete;

  std::size_t threads() const { return others_.size() + 1; }
  // Calls work(worker, i) once for each i below `count`, and returns when all are done. `worker` is below
  // threads(), 0 the calling thread; calls of one worker come one after the other. `work` must not throw: the
  // program would end.
  // cost(i): how long that takes, in any unit; the shares are as equal as that says.
  template <typename Cost, typename Work>
  void run(std::size_t count, Cost cost, Work& work) {
    std::size_t whole = 0, done = 0, first = 0;
    for (std::size_t i = 0; i < count; ++i) whole += cost(i);
    for (std::size_t worker = 0, end = 0; worker < threads(); ++worker, first = end) {
      while (end < count && (worker + 1 == threads() || done * threads() < whole * (worker + 1)))
        done += cost(end++);
      shares_[worker].left.store(pack(first, end), std::memory_order_relaxed);
    }
    work_ = &work;
    call_ = [](void* what, std::size_t worker, std::size_t i) { (*static_cast<Work*>(what))(worker, i); };
    run_all();
  }

 private:
  // The rest of a thread's share: its first index, and its end.
  struct alignas(64) Share {
    std::atomic<std::uint64_t> left{0};
  };
  static std::uint64_t pack(std::size_t first, std::size_t end) { return first << 32 | end; }

  void run_all();
  // Calls what is left of a share: its own from the front, another one's from behind.
  void take_turns(std::size_t worker, Share& share, bool own) noexcept;
  void take_all_turns(std::size_t worker);
  // Returns once the number is another one.
  void await_change(const std::atomic<std::uint32_t>& number, std::uint32_t old) const;
  void serve(std::size_t worker);  // a thread's whole life
  void end();

  // The present work: run_all() writes it before round_ grows, and the others read it after.
  void* work_ = nullptr;
  void (*call_)(void*, std::size_t, std::size_t) = nullptr;
  bool ending_ = false;
  std::vector<Share> shares_;                        // by worker
  int most_looks_ = 0;                               // at a number, before a thread sleeps until it changes
  alignas(64) std::atomic<std::uint32_t> round_{0};  // grows with each run
  alignas(64) std::atomic<std::uint32_t> busy_{0};   // threads that have not finished the round
  std::vector<std::thread> others_;
};

}  // namespace visum::dynamics::impulse
