// The thread that reads the buses' channels as soon as something comes, whatever the tick does. It decodes
// requests and hands them to the tick's thread. That one writes the answers itself, which saves waking a
// thread. Requests and answers cross in two bounded queues, and a mutex guards the channels. In real time the
// tick's thread never waits for the mutex: where it is taken, the bus thread writes the answers.
#pragma once

#include <poll.h>

#include <atomic>
#include <boost/lockfree/spsc_queue.hpp>
#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <thread>
#include <vector>

#include "protocol/messages.h"
#include "server/bus/bus_item.h"
#include "server/bus/bus_link.h"

namespace visum::bus {

// Owned by Buses. Its public functions belong to the tick's thread.
class BusThread {
 public:
  static constexpr std::size_t kQueue = 1024;      // more are lost, as in a receiver that overruns
  static constexpr std::size_t kMaxChannels = 16;  // of one link; more are turned away

  struct Wiring {
    std::unique_ptr<BusLink> link;
    std::uint32_t part = 0;
    bool warned = false;                                  // that a client discards its output
    bool warned_of_drops = false;                         // that a client does not read
    std::chrono::steady_clock::time_point rests_until{};  // until then its listener is not polled
  };
  // `on_request` is called on the thread, after requests were queued.
  BusThread(std::vector<Wiring> wirings, std::function<void()> on_request);
  ~BusThread();

  // The tick's side.
  bool next_request(BusItem& item) { return requests_.pop(item); }
  void answer(const BusItem& item) { answers_.push(item); }
  void flush();  // after the last answer() of a batch
  // Frames and lines that were dropped because a client did not read, so far. Any thread.
  std::uint64_t dropped() const { return dropped_.load(std::memory_order_relaxed); }

  // The same for a world that waits for its clients. These wait for the mutex, so that everything is done
  // when they return. settle() reads all that clients have written by now. It also waits for the bytes that
  // `streams` promise, which may still be on their way; false: they did not come within `patience`. A client
  // that goes on writing is heard no longer than that. A connection that does not come within kGrace counts
  // as gone until it does, so no later call waits for it.
  static constexpr std::chrono::milliseconds kPatience{5000};  // for bytes that were written, on loopback
  static constexpr std::chrono::milliseconds kGrace{250};      // for connections that were made there
  // The bus thread rests until kFollowed after the last settle(). A request of a client that is not followed
  // may wait for so long, or for the next settle().
  static constexpr std::chrono::milliseconds kFollowed{1};
  bool settle(const std::vector<protocol::Stream>& streams, std::chrono::milliseconds patience = kPatience);
  void send_now();
  std::uint64_t said();  // bytes written to pseudo terminals and CAN interfaces so far
  void fill_in(std::vector<protocol::Stream>& streams);  // only those that are one of the channels

 private:
  template <typename T>
  using Queue = boost::lockfree::spsc_queue<T, boost::lockfree::capacity<kQueue>>;
  struct OpenChannel {
    std::unique_ptr<Channel> channel;
    std::uint32_t link = 0;
  };

  void run();
  // Blocks until a descriptor is ready. Channels may come and go meanwhile: whoever changes them wakes us.
  void wait();
  // Waits until settle() has not been called for kFollowed, or until wake().
  void rest_while_followed();
  // The descriptors to poll: that of wake(), then the listeners, then the channels.
  std::vector<pollfd> watched() const;
  // Polls them without waiting.
  std::vector<pollfd> look() const;
  // Reads and accepts what is ready. True: a channel or a listener had something.
  bool serve(const std::vector<pollfd>& ready);
  bool has_come(const protocol::Stream& stream) const;
  // Counts connections that did not come as gone. True: one of them was not given up before.
  bool give_up_missing(const std::vector<protocol::Stream>& streams);
  // The channel of a TCP client's port; null: there is none.
  const Channel* channel_of(std::uint32_t port) const;
  // Accepts a client at a link. False: none came, or there was no descriptor for it.
  bool admit(std::uint32_t link);
  void read(std::uint64_t number, OpenChannel& line);
  // Queues a request for the tick's thread. On CAN all other channels of the part see it, too.
  void take(std::uint64_t number, const OpenChannel& line, const powercube::Telegram& telegram,
            powercube::BusFraming framing);
  // Warns once that a client discards its own output.
  void warn(Wiring& wiring);
  void send_answers();
  // Sends to all CAN channels of `part`, apart from the channel `except`.
  void spread(std::uint32_t part, const powercube::Telegram& telegram, std::uint64_t except);
  // To be called by another thread that has written: this one writes the rests of frames once there is room.
  void leave_rests();
  void count_dropped();
  void wake();

  std::vector<Wiring> wirings_;
  std::function<void()> on_request_;
  std::mutex turn_;                             // to read, write, add or remove channels
  std::map<std::uint64_t, OpenChannel> lines_;  // by number; destroyed before the links
  std::uint64_t next_number_ = 1;
  std::set<std::uint32_t> gone_;  // TCP: ports of clients that went, were turned away or never came
  Queue<BusItem> requests_, answers_;
  std::uint64_t dropped_by_gone_ = 0;
  std::atomic<std::uint64_t> dropped_{0};
  bool queued_ = false;  // requests, in this round
  int wake_fd_;
  std::atomic<bool> ending_{false};
  std::atomic<std::chrono::steady_clock::time_point> followed_until_{};
  std::thread thread_;
};

}  // namespace visum::bus
