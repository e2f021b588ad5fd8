// Serves the sessions while a tick takes long. In lockstep and free, one thread ticks and serves the
// sessions; a tick of minutes would leave them without an answer. Then a second thread relieves it until the
// tick ends. It also ends a daemon that was asked to end and whose tick does not.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <thread>

namespace visum::gateway {

// Owned by the daemon's loop, which makes it before its first tick and destroys it after the last. Time is
// counted in looks, ten a second, and not read from a clock: a process that was stopped was not held up. On
// the tick's thread, leave() and take_back() are one atomic operation each as long as nothing takes long.
class Relief {
 public:
  static constexpr std::chrono::milliseconds kLook{100};
  static constexpr std::chrono::milliseconds kFarewell{500};  // for clients, where a tick is abandoned
  static constexpr int kLooksToRelieve = 2;                   // of one and the same absence
  static constexpr int kLooksToAbandon = 20;  // of one and the same tick, after the daemon was asked to end

  // All are called on the relief's thread.
  struct Duties {
    // The sessions are the relief's from now on (true), or the tick's thread gets them back (false).
    std::function<void(bool)> relieve;
    std::function<void(std::chrono::nanoseconds)> serve;  // at most for so long, and until wake()
    std::function<void()> wake;                           // on the tick's thread
    std::function<bool()> is_to_end;
    std::function<std::uint64_t()> tick;  // the number of the tick that is being done; 0: none
    // This tick does not end, and the daemon was to end. Returns only where that is no longer so.
    std::function<void(std::uint64_t tick)> abandon;
  };
  // Without `relieve` the sessions have a thread of their own, and only abandoning is done here.
  explicit Relief(Duties duties);
  ~Relief();
  Relief(const Relief&) = delete;
  Relief& operator=(const Relief&) = delete;

  // The tick's thread. Between the two it must not touch the sessions.
  void leave();
  // Waits until the relief has let go of the sessions, which is soon. True: it had served them.
  bool take_back();

 private:
  enum State : std::uint32_t { kServing, kAway, kRelieved, kBack };

  void run();
  void look();
  void look_at_end();
  // Serves the sessions until the tick's thread is back.
  void stand_in();

  const Duties duties_;
  std::atomic<std::uint32_t> state_{kServing};
  std::atomic<std::uint64_t> absences_{0};
  std::uint64_t absence_ = 0;  // the relief's thread: the one that it looked at last
  int looks_ = 0;              // at that one
  std::uint64_t last_tick_ = 0;
  int looks_at_end_ = 0;
  std::mutex mutex_;
  std::condition_variable wake_;
  bool ended_ = false;
  std::thread thread_;  // last, because it uses the members above
};

}  // namespace visum::gateway
