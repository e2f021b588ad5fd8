// The mailbox between the sessions' thread and the tick's thread: bounded queues without a lock, each with
// one producer and one consumer. Inputs (writes, pushes, leases) wait for the next tick border. Commands
// (reset, snapshot, parameters, ...) are carried out at once, and come back with their reply.
#pragma once

#include <atomic>
#include <boost/lockfree/spsc_queue.hpp>
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <semaphore>
#include <vector>

#include "hwparts/fault_set.h"
#include "protocol/messages.h"
#include "server/dynamics/engine.h"
#include "server/gateway/world_view.h"

namespace visum::gateway {

// A change that is latched for the next tick border. Inputs are applied in the order of (part, lease epoch,
// arrival), so that it does not matter which of two clients' bytes came first.
struct Input {
  enum class Kind {
    kWrite,
    kLeaseGranted,
    kLeaseReleased,
    kLeaseLost,
    kPush,
    kFault,
    kClearFault,
    kSessionEnded
  };
  Kind kind = Kind::kWrite;
  std::uint32_t part = 0;        // its number in the gateway (part_table.h)
  std::uint32_t generation = 0;  // of that number: the input is dropped where the part is gone
  // The part's lease; pushes, faults: see order_of(); kSessionEnded: the session.
  std::uint64_t epoch = 0;
  std::uint32_t first_port = 0;                     // kWrite
  std::vector<double> values;                       // kWrite; its capacity is kept
  std::chrono::steady_clock::time_point read_at{};  // kWrite: when it was sent to the tick's side
  std::int64_t deadline_ticks = 0;                  // kLeaseGranted; 0: none
  dynamics::Wrench wrench{};                        // kPush
  std::uint64_t revision = 0;                       // kPush: of the world that the body's number belongs to
  std::optional<Eigen::Vector3d> push_point;  // kPush: where the force acts, in W; none: the centre of mass
  std::int64_t duration_ticks = 0;            // kPush, kFault (0: until it is cleared)
  hwparts::Fault fault{};                     // kFault
  std::optional<hwparts::FaultKind> fault_kind;  // kClearFault; none: all
  std::optional<std::size_t> fault_drive;        // kClearFault; none: all
  std::uint64_t arrival = 0;
};

// A request that the tick's thread answers. Made, and freed, by the sessions' side.
struct Command {
  std::uint64_t session = 0;
  std::uint64_t id = 0;
  std::uint32_t part = 0;        // the part that the request is about, if any
  std::uint32_t generation = 0;  // of its number
  protocol::Request request;
  bool acknowledged = false;                        // was answered before it was done: its reply is dropped
  protocol::Reply reply;                            // filled by the tick's side
  std::vector<protocol::WriteBlackboard> pieces{};  // of an UnlockBlackboard: what was written
  std::unique_ptr<WorldView> view;                  // filled if the world's description changed
  // A change of the bodies leaves things over, such as the old world's scene and machinery: freed with the
  // command, since that takes longer than a tick has.
  std::shared_ptr<void> left_over{};
};

// News from the tick's side that no request asked for.
struct Notice {
  enum class Kind { kDeadlineMissed, kSilent, kStopped, kWriteDropped, kPushRefused, kFaultRefused };
  Kind kind = Kind::kDeadlineMissed;
  std::uint32_t part = 0;
  std::uint32_t generation = 0;  // of the part's number
  std::uint64_t epoch = 0;       // of the lease that this ended; kStopped: 0 where it ended none
  std::int64_t tick = 0;
};

// Owned by the daemon; must outlive both sides. In lockstep and free one thread uses both ends.
class Mailbox {
 public:
  static constexpr std::size_t kInputs = 1024;
  static constexpr std::size_t kUrgent = 128;  // of the inputs
  static constexpr std::size_t kCommands = 256;

  explicit Mailbox(std::size_t most_ports);  // of any part
  ~Mailbox();

  // The sessions' side.
  // A blank to be filled and sent; null: the queue is full. kUrgent of them are kept back for inputs that
  // must not be lost.
  Input* blank_input(bool urgent = false);
  void send(Input* input);
  bool send(std::unique_ptr<Command> command);  // false: full
  std::unique_ptr<Command> next_done();         // none: nothing came back
  bool next_notice(Notice& notice);
  void beat() { beats_.fetch_add(1, std::memory_order_relaxed); }  // the sessions' thread came round

  // The tick's side.
  struct Item {
    Input* input = nullptr;
    Command* command = nullptr;
  };
  bool next(Item& item);
  bool has_items() const { return sent_.read_available() > 0; }
  void give_back(Input* input);
  void give_back(std::unique_ptr<Command> command);
  void tell(const Notice& notice);                   // dropped where the queue is full
  void wait_for(std::chrono::milliseconds at_most);  // until something was sent
  void wake();                                       // makes wait_for return; any thread
  std::uint64_t beats() const { return beats_.load(std::memory_order_relaxed); }

 private:
  template <typename T, std::size_t N>
  using Queue = boost::lockfree::spsc_queue<T, boost::lockfree::capacity<N>>;

  std::vector<Input> pool_;
  std::uint64_t arrivals_ = 0;
  Queue<Input*, kInputs> blanks_;
  Queue<Item, kInputs + kCommands> sent_;
  Queue<Command*, kCommands> done_;
  Queue<Notice, kInputs> notices_;
  std::size_t commands_out_ = 0;  // sent and not yet back
  std::atomic<std::uint64_t> beats_{0};
  std::atomic<bool> woken_{false};  // arrived_ has been released, and wait_for() has not returned since
  std::binary_semaphore arrived_{0};
};

}  // namespace visum::gateway
