// The thread that reads the buses' channels, at once, whatever the tick does. It decodes and hands requests
// to the tick's thread, which writes the answers itself: one thread less to wake. They meet in two bounded
// queues, and take turns at the channels; the tick's thread never waits for its turn, but leaves the answers
// to the other.
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

class BusThread {
 public:
  static constexpr std::size_t kQueue = 1024;      // more is lost, as in a receiver that overruns
  static constexpr std::size_t kMaxChannels = 16;  // of one link; more are turned away

  struct Wiring {
    std::unique_ptr<BusLink> link;
    std::uint32_t part = 0;
    bool warned = false;                                  // of a client that discards its output
    std::chrono::steady_clock::time_point rests_until{};  // who waits at its listener is not looked at
  };
  // `on_request` is called on the thread, after requests were queued.
  BusThread(std::vector<Wiring> wirings, std::function<void()> on_request);
  ~BusThread();

  // The tick's side.
  bool next_request(BusItem& item) { return requests_.pop(item); }
  void answer(const BusItem& item) { answers_.push(item); }
  void flush();  // after the last answer() of a batch
  // The same for a world that waits for its clients: waits for its turn, so that all is done when it returns.
  // settle() reads what clients have written by now, and what `streams` promise, which may still be on its
  // way; false where that does not come within `patience`. Who goes on writing is heard no longer than that.
  // A connection that does not come within kGrace counts as gone until it does: no later call waits for it.
  static constexpr std::chrono::milliseconds kPatience{5000};  // for bytes that were written, on loopback
  static constexpr std::chrono::milliseconds kGrace{250};      // for connections that were made there
  bool settle(const std::vector<protocol::Stream>& streams, std::chrono::milliseconds patience = kPatience);
  void send_now();
  std::uint64_t said();  // bytes written to pseudo terminals and CAN interfaces so far
  void fill_in(std::vector<protocol::Stream>& streams);  // those that are a channel's

 private:
  template <typename T>
  using Queue = boost::lockfree::spsc_queue<T, boost::lockfree::capacity<kQueue>>;
  struct OpenChannel {
    std::unique_ptr<Channel> channel;
    std::uint32_t link = 0;
  };

  void run();
  void wait();
  std::vector<pollfd> watched() const;
  std::vector<pollfd> look() const;
  bool serve(const std::vector<pollfd>& ready);
  bool has_come(const protocol::Stream& stream) const;
  bool give_up_missing(const std::vector<protocol::Stream>& streams);
  const Channel* channel_of(std::uint32_t port) const;
  bool admit(std::uint32_t link);
  void read(std::uint64_t number, OpenChannel& line);
  void take(std::uint64_t number, const OpenChannel& line, const powercube::Telegram& telegram,
            powercube::BusFraming framing);
  void warn(Wiring& wiring);
  void send_answers();
  // To all CAN channels of `part` but `except`.
  void spread(std::uint32_t part, const powercube::Telegram& telegram, std::uint64_t except);
  void wake();

  std::vector<Wiring> wirings_;
  std::function<void()> on_request_;
  std::mutex turn_;                             // to read, write, add or remove channels
  std::map<std::uint64_t, OpenChannel> lines_;  // by number; destroyed before the links
  std::uint64_t next_number_ = 1;
  std::set<std::uint32_t> gone_;  // TCP: ports of clients that went, were turned away or never came
  Queue<BusItem> requests_, answers_;
  bool queued_ = false;  // requests, in this round
  int wake_fd_;
  std::atomic<bool> ending_{false};
  std::thread thread_;
};

}  // namespace visum::bus
