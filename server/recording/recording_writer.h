// The thread that writes a recording's file, so that a tick never waits for a disk. The tick's thread hands
// it messages through a bounded queue; where the disk is full, gone or slower than the queue is long, the
// recording ends there, and says so in the log, and the ticks go on. What is written is on its way to the
// disk half a second later at the latest.
#pragma once

#include <atomic>
#include <boost/lockfree/spsc_queue.hpp>
#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "protocol/recording/mcap_writer.h"

namespace visum::recording {

class RecordingWriter {
 public:
  static constexpr std::size_t kQueueBytes = 32u << 20;
  static constexpr std::size_t kMaxLines = 1000;  // of the log that wait to be written; more are dropped

  enum class Overflow {
    kEnd,   // the recording ends: a realtime world does not wait
    kWait,  // the tick waits for room, as time does not count in it; for ten seconds at most
  };

  // Makes the file anew. Throws std::runtime_error where that cannot be.
  RecordingWriter(const std::filesystem::path& file, Overflow overflow);
  ~RecordingWriter();  // writes what waits, and the summary

  // For what stands at the beginning; until start().
  McapWriter& writer() { return writer_; }
  // The first message of a world with a past, which may be longer than the queue; until start().
  void put_first(std::uint16_t channel, std::uint64_t publish_time_ns, Bytes data);
  void start();

  // One thread, the tick's. Does nothing once the recording has ended.
  void put(std::uint16_t channel, std::uint64_t log_time_ns, std::uint64_t publish_time_ns, Bytes data);
  // The same thread. Whether a message that nobody needs may be put: it would wait for little, and leave
  // room.
  bool has_room_for(std::size_t bytes) const;
  // Any thread. Stands in the file at the times of the message before it.
  void put_line(std::uint16_t channel, std::vector<std::byte> data);

  bool ended() const { return ended_.load(std::memory_order_relaxed); }

 private:
  struct Head {
    std::uint16_t channel;
    std::uint32_t size;
    std::uint64_t log_time_ns, publish_time_ns;
  };
  struct LogEntry {
    std::uint16_t channel;
    std::vector<std::byte> data;
  };

  void run();
  void work();  // writes what waits
  void write_lines();
  void write(Bytes bytes);
  bool make_room(std::size_t bytes);
  void end(const std::string& why);

  struct Descriptor {
    ~Descriptor();
    int fd;
  };

  const std::filesystem::path file_;
  const Overflow overflow_;
  const Descriptor out_;
  McapWriter writer_;
  boost::lockfree::spsc_queue<std::byte> queue_{kQueueBytes};
  std::vector<std::byte> message_;                       // the tick's thread: in the making
  std::vector<std::byte> taken_;                         // the recording writer's
  std::uint64_t last_log_ns_ = 0, last_publish_ns_ = 0;  // likewise: times of the last message
  std::atomic<bool> ended_{false};
  std::mutex mutex_;  // of lines_ and stopping_
  std::condition_variable stopped_;
  std::vector<LogEntry> lines_;
  bool stopping_ = false;
  std::thread thread_;
};

}  // namespace visum::recording
