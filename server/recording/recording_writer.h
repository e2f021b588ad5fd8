// Writes a recording's file on a thread of its own, so that a tick never waits for a disk. The tick's thread
// hands it messages through a bounded queue. Where the disk is full or gone, where the queue overflows
// because the disk is slow, or where memory runs out, the recording ends there. The log says so, and the
// ticks go on. A message is handed to the operating system at most half a second after it was put.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <string_view>
#include <thread>
#include <vector>

#include "protocol/recording/mcap_writer.h"
#include "server/recording/byte_queue.h"

namespace visum::recording {

inline constexpr const char* kNoMemory = "not enough memory is left for what comes";

class RecordingWriter {
 public:
  static constexpr std::size_t kQueueBytes = 32u << 20;
  static constexpr std::size_t kMaxLines = 1000;  // of the log that wait; more are dropped

  enum class Overflow {
    kEnd,   // the recording ends: a realtime world does not wait
    kWait,  // the tick waits for room, ten seconds at most: the world is not bound to the wall clock
  };

  // Makes the file, or empties the one that is there. Throws std::runtime_error where that fails, also where
  // another program is writing it; the text is the reason alone.
  RecordingWriter(const std::filesystem::path& file, Overflow overflow);
  ~RecordingWriter();  // as close()

  // Order of calls: writer() for the beginning, put_first() where the world has a past, start(), then put()
  // and put_line() as often as needed. After start() the writer belongs to the thread.
  McapWriter& writer() { return writer_; }
  // The state that the recording begins with. It may be longer than the queue.
  void put_first(std::uint16_t channel, std::uint64_t publish_time_ns, Bytes data);
  void start();
  bool started() const { return started_; }  // any thread

  // Tick's thread. Does nothing once the recording has ended.
  void put(std::uint16_t channel, std::uint64_t log_time_ns, std::uint64_t publish_time_ns, Bytes data);
  // Tick's thread. Whether an optional message of this length may be put: it takes at most half of the
  // queue's room.
  bool has_room_for(std::size_t bytes) const;
  // Writes the waiting messages and the file's summary, and ends the recording. Returns whether the file
  // holds all that was put. Not from the writer's own thread; a second call does nothing more.
  bool close();
  // Any thread. The line gets the times of the message that is written before it.
  void put_line(std::uint16_t channel, std::vector<std::byte> data);

  // Any thread: ends the recording and logs why, once.
  void end(std::string_view why);
  bool ended() const { return ended_.load(std::memory_order_relaxed); }

 private:
  struct Head {  // stands before each message in the queue
    std::uint16_t channel;
    std::uint32_t size;
    std::uint64_t log_time_ns, publish_time_ns;
  };
  struct LogEntry {
    std::uint16_t channel;
    std::vector<std::byte> data;
  };

  // The thread's loop, until the destructor stops it.
  void run();
  // Writes everything that waits in the queue.
  void work();
  void write_lines();
  // Writes to the file descriptor; throws where that fails.
  void write(Bytes bytes);
  // Waits for room in the queue where `overflow_` allows it; false: there is none.
  bool make_room(std::size_t bytes);
  struct Descriptor {
    ~Descriptor();
    int fd;
  };

  const std::filesystem::path file_;
  const Overflow overflow_;
  const Descriptor out_;
  McapWriter writer_;
  ByteQueue queue_{kQueueBytes};
  std::uint64_t last_log_ns_ = 0, last_publish_ns_ = 0;  // this thread: times of the last message
  std::atomic<bool> started_{false}, ended_{false};
  std::mutex mutex_;  // guards lines_ and stopping_
  std::condition_variable stopped_;
  std::vector<LogEntry> lines_;
  bool stopping_ = false;
  std::thread thread_;
};

}  // namespace visum::recording
