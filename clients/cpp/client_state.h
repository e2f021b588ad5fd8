// The state of visum.h's Client and Part. Private to this folder, and used on the thread of the Client.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "clients/cpp/visum.h"
#include "protocol/client.h"

namespace visum::detail {

Error to_error(const protocol::RequestError& refusal, const std::string& part = {},
               const std::string& port = {});
Error to_error(const protocol::Error& refusal, const std::string& part = {}, const std::string& port = {});

struct PartState {
  ClientState* client = nullptr;  // null once the client is gone
  std::string name, kind;
  std::vector<PortInfo> input_ports, output_ports;
  std::vector<BlackboardInfo> blackboards;

  std::vector<double> inputs;  // as staged, else as in force
  std::vector<bool> set, staged,
      last_write;  // by controller input: set since acquire(), since the last write, and sent by it
  std::vector<double> outputs;  // of the newest sample
  std::int64_t tick = 0, time_ns = 0;
  std::uint64_t era = 0;
  bool fresh = false;  // an advance has brought a sample, and no read() has used it yet
  // Blackboards that were read since the last advance, and between the two before it; and what an advance has
  // brought of them.
  std::set<std::string> boards_read, boards_read_before;
  std::map<std::string, std::vector<std::byte>> boards;

  bool leased = false;
  int exceptions_at_acquire = 0;

  ClientState& connected() const;  // throws kConnection if the client is gone
  // Takes in a sample, except for inputs that were set under the lease.
  void apply(const protocol::PartSample& sample);
  // The end of the longest run of set ports that begins at `first` and ends with a staged port.
  std::size_t end_of_run(std::size_t first) const;
  void end_lease();
  void forget_writes();
  // An advance begins. Returns the blackboards that it should bring along: those that were read in the last
  // two periods.
  std::vector<std::string> next_blackboards();
};

// A Write that was sent, and whose answer was not read yet.
struct PendingWrite {
  std::uint64_t id;
  std::string part;
  std::size_t first_port, count;
};

struct ClientState {
  std::optional<protocol::Connection> connection;  // empty once dropped
  ServerInfo server;
  std::vector<PartState*> parts;  // all living parts, in the order in which they were made
  std::deque<PendingWrite> pending;

  std::int64_t tick = 0, time_ns = 0;
  std::uint64_t era = 0;
  bool holds_world = false;              // the clock is lockstep, and this client has joined
  std::vector<std::uint64_t> advancing;  // the requests of the advance that is under way; empty: none is
  std::vector<protocol::ReadBlackboard> advancing_boards;  // the last ones of them
  std::uint64_t requests = 0;    // counts those of the program that are not part of an advance
  std::uint64_t brought_at = 0;  // what `requests` was when the last advance in lockstep ended
  std::int64_t ahead_ns = 0;     // how far the ticks asked for are ahead of the sum of the periods

  static constexpr std::size_t kMaxPending = 32;  // writes in flight before one is waited for

  protocol::Connection& link();  // throws kConnection if it was dropped
  // Sends a write, and does not wait for its answer.
  void post(const PartState& part, protocol::Write write);
  void advance(std::int64_t ticks);
  void read_all();
  void begin_advance(std::int64_t ticks);
  bool advanced(std::chrono::milliseconds patience);  // false: the world is not there yet
  void set_time(std::int64_t tick, std::int64_t time_ns, std::uint64_t era);
  // Waits for the answers to all writes in flight. Returns the first refusal.
  std::optional<Error> settle();
  void throw_refusals();
  // Takes in lockstep what the last advance has brought, if nothing was asked since.
  std::vector<std::byte> read_blackboard(PartState& part, const std::string& name);

  // One round trip. A refusal becomes an Error with part and port.
  protocol::Reply request(const protocol::Request& request, const std::string& part = {},
                          const std::string& port = {});
  template <typename T>
  T request_as(const protocol::Request& message, const std::string& part = {}, const std::string& port = {}) {
    return as<T>(request(message, part, port));
  }
  template <typename T>
  static T as(protocol::Reply reply) {
    if (auto* value = std::get_if<T>(&reply)) return std::move(*value);
    throw Error(ErrorCode::kMalformed, "the server answered with a message of another kind");
  }

 private:
  void finish_advance(const protocol::Reply& reply);
  // Sends a request for a sample of each part, behind `messages`, and then those for blackboards. Returns the
  // ids of all.
  std::vector<std::uint64_t> send_with_reads(std::vector<protocol::Request> messages,
                                             std::span<const protocol::ReadBlackboard> boards);
  void take_sample(PartState& part, protocol::Reply reply);
  void take_blackboard(const protocol::ReadBlackboard& board, protocol::Reply reply);
  // The Error for a refused advance: the lockstep's time-out if that is the reason.
  Error explain(const protocol::Error& refusal);
  protocol::Reply wait(std::uint64_t id);
  std::optional<Error> settle_oldest();
  // Forgets a refused write: it is not in force, and no later write may take it along.
  void disown(const PendingWrite& refused);
};

}  // namespace visum::detail
