// The memory that the time shim shares with the scheduler that drives its time: one slot for each thread of
// the program and of the processes that it starts. SPEC.md says which side may change which field, and when.
// Needs no library.
#pragma once

#include <atomic>
#include <cstdint>
#include <limits>

namespace visum::shim {

inline constexpr std::uint32_t kMagic = 0x56535435;         // of this layout
inline constexpr const char* kVariable = "VISUM_LOCKSTEP";  // the file's path, in the environment
inline constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();

inline constexpr std::uint32_t kMostThreads = 256, kMostProcesses = 64, kMostStreams = 64, kMostBuses = 32;
inline constexpr int kNameSize = 24;

// The clocks at simulated time 0: midnight of 1 January 2000 (UTC), and 1000 s after the system's start.
inline constexpr std::int64_t kRealtimeBase_ns = 946'684'800'000'000'000;
inline constexpr std::int64_t kMonotonicBase_ns = 1'000'000'000'000;

enum class State : std::uint32_t {
  kFree,      // not in use
  kStarting,  // reserved for a thread or process that is about to start
  kRunning,
  kParked,   // waits on `go`, until its deadline or as its flags say
  kBlocked,  // in a system call that ends by itself
  kReady,    // came back from such a call, or has just started; waits on `go` for its turn
  kLeaving,  // in its last instructions
};

enum Flags : std::uint32_t {
  kRecheck = 1,        // looks again when others have run, or a bus has sent something
  kOnBus = 2,          // waits for a bus: the world may run though no thread waits for time
  kSettle = 4,         // asks that all bytes sent over the buses be handled and answered
  kGranted = 8,        // it has been given the thing that it waited for
  kAlarm = 16,         // told with its turn: send yourself SIGALRM
  kAgain = 32,         // has looked again, in vain
  kHold = 64,          // kBlocked: waits for an answer of the server, and the world waits with it
  kAwaitsChild = 128,  // kBlocked: until the child `key` ends, or, where that is 0, any child
  kReplacing = 256,    // calls exec(): the program that follows has not announced itself yet
};

struct Slot {
  std::atomic<State> state;
  std::atomic<std::uint32_t> go;  // futex: changes with each turn
  std::atomic<std::uint32_t> flags;
  std::atomic<std::int32_t> pid, tid, parent;  // parent: of a kStarting process
  std::atomic<std::int64_t> deadline_ns;       // simulated
  std::atomic<std::uint64_t> checked;          // `activity` when it looked last
  std::atomic<std::uint64_t> ticket;           // order of waiting
  std::atomic<std::uint64_t> key;              // the condition variable, or child, that it waits for
  char doing[kNameSize];                       // "nanosleep", for messages
};

// A process' ITIMER_REAL.
struct Alarm {
  std::atomic<std::int32_t> pid;
  std::atomic<std::int64_t> deadline_ns, interval_ns;
};

// A TCP connection of the program with the server; see protocol/visum.proto, Stream.
struct Stream {
  std::atomic<std::uint32_t> port;  // the program's; 0: none
  std::atomic<std::uint64_t> written, heard;
  std::atomic<std::uint64_t> said;  // bytes that the server has sent, by its own count
  // 1 + `heard` when the program had left so much unread that the server could send no more; 0: never.
  std::atomic<std::uint64_t> full_at;
};

struct Shared {
  std::uint32_t magic;
  std::int32_t scheduler;  // process
  std::int64_t tick_ns;
  std::uint64_t pid_namespace;  // of the scheduler
  std::uint32_t tty_count, port_count;
  std::uint32_t session_port;       // the server's own, for the ports over TCP
  std::uint64_t ttys[kMostBuses];   // pseudo terminals of buses: st_rdev
  std::uint16_t ports[kMostBuses];  // TCP, on loopback
  std::atomic<std::int64_t> now_ns;
  std::atomic<std::uint64_t> activity, tickets;
  std::atomic<std::uint32_t> bell;               // futex: rung when nobody runs any more
  std::atomic<std::uint32_t> dirty;              // something was written to a bus since it was settled
  std::atomic<std::uint32_t> used;               // slots in use lie below
  std::atomic<std::uint32_t> program_announced;  // the command itself has loaded the shim
  std::atomic<std::int32_t> stranger_of;         // a process whose child never loaded it; 0: none
  std::atomic<std::int32_t> host_timer_of;       // a process with a timer of the host's; 0: none
  std::atomic<std::uint32_t> elsewhere;          // a process of another process namespace loaded it
  Alarm alarms[kMostProcesses];
  Stream streams[kMostStreams];
  Slot slots[kMostThreads];
};

static_assert(std::atomic<std::uint64_t>::is_always_lock_free && sizeof(State) == 4);

}  // namespace visum::shim
