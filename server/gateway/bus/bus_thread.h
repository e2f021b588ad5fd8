// The thread that reads and writes the buses' channels. It reads at once, whatever the tick does: m5api's
// clients flush their line before each write, and what still lies there then is lost. It decodes, hands
// requests to the tick's thread, and writes the answers that come back; it knows no module. The two sides
// meet in two bounded queues without a lock.
#pragma once

#include <atomic>
#include <boost/lockfree/spsc_queue.hpp>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <thread>
#include <vector>

#include "server/gateway/bus/bus_link.h"

namespace visum::gateway {

// A telegram on its way through the queues.
struct BusItem {
  std::uint32_t link = 0;     // by which it came, or by which it goes
  std::uint64_t channel = 0;  // by number; answers to CAN go to all CAN channels of the link's part
  powercube::Wire wire = powercube::Wire::kSerial;
  powercube::Telegram telegram;
};

class BusThread {
 public:
  static constexpr std::size_t kQueue = 1024;      // more is lost, as in a receiver that overruns
  static constexpr std::size_t kMaxChannels = 16;  // of one link; more are turned away

  struct Wiring {
    std::unique_ptr<BusLink> link;
    std::uint32_t part = 0;
  };
  // `on_request` is called on the thread, after requests were queued.
  BusThread(std::vector<Wiring> wirings, std::function<void()> on_request);
  ~BusThread();

  // The tick's side.
  bool next_request(BusItem& item) { return requests_.pop(item); }
  void answer(const BusItem& item) { answers_.push(item); }
  void flush();  // after the last answer() of a batch

 private:
  template <typename T>
  using Queue = boost::lockfree::spsc_queue<T, boost::lockfree::capacity<kQueue>>;
  struct Line {
    std::unique_ptr<Channel> channel;
    std::uint32_t link = 0;
  };

  void run();
  void poll_all();
  void admit(std::uint32_t link);
  void read(std::uint64_t number, Line& line);
  void take(std::uint64_t number, const Line& line, const powercube::Telegram& telegram,
            powercube::Wire wire);
  void send_answers();
  // To all CAN channels of `part` but `except`.
  void spread(std::uint32_t part, const powercube::Telegram& telegram, std::uint64_t except);
  void wake();

  std::vector<Wiring> wirings_;
  std::function<void()> on_request_;
  std::map<std::uint64_t, Line> lines_;  // by number; destroyed before the links
  std::uint64_t next_number_ = 1;
  Queue<BusItem> requests_, answers_;
  bool queued_ = false;  // requests, in this round
  int wake_fd_;
  std::atomic<bool> ending_{false};
  std::thread thread_;
};

}  // namespace visum::gateway
