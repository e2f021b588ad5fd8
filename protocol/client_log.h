// Lines of the log that clients cause. One client causes at most 20 a second; further ones are left out and
// counted, and the log says how many. A line that is left out changes nothing else. On the server's thread.
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "protocol/token_bucket.h"

namespace visum::protocol {

// Decides which lines are written, without a clock and without a log.
class LineLimit {
 public:
  using Time = TokenBucket::Time;
  static constexpr double kLinesPerSecond = 20.0;  // with those that say how many were left out

  explicit LineLimit(Time now) : lines_(kLinesPerSecond / 2 - 1, now), told_at_(now) {}

  // True: write the line. False: it counts as left out.
  bool allows(Time now);
  // The lines that were left out and are to be told of; 0 while that is less than a second ago.
  std::uint64_t take_left_out(Time now);
  // The same, at once.
  std::uint64_t take_rest();
  // A new limit would decide alike.
  bool is_idle(Time now) const { return left_out_ == 0 && lines_.is_full(now); }

 private:
  TokenBucket lines_;  // in any second twice its rate, and one line of ours
  std::uint64_t left_out_ = 0;
  Time told_at_;
};

enum class LogLevel { kDebug, kWarning, kError };

// The lines of one client. Its end tells what was left out last.
class ClientLog {
 public:
  // `who` is named where lines are left out.
  explicit ClientLog(std::string who);
  ~ClientLog();
  ClientLog(const ClientLog&) = delete;
  ClientLog& operator=(const ClientLog&) = delete;

  void write(LogLevel level, const std::string& text);
  // Tells of lines that were left out, if that is due.
  void sweep();
  bool is_idle() const;

 private:
  const std::string who_;
  LineLimit limit_;
};

// The lines of clients that have not said Hello, by their address.
class AddressLogs {
 public:
  static constexpr std::size_t kMaxAddresses = 256;  // all further ones share one limit

  // `peer` is an address with a port: "127.0.0.1:43210".
  ClientLog& of(const std::string& peer);
  void sweep();

 private:
  std::map<std::string, ClientLog> logs_;
  ClientLog others_{"further addresses"};
};

}  // namespace visum::protocol
