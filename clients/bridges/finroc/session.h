// One connection of a Finroc peer, without its socket. Finroc's tools open two: one for the structure and for
// calls, one for values. Malformed bytes end the connection or are skipped, as Finroc's own server does.
#pragma once

#include <chrono>
#include <map>
#include <optional>
#include <vector>

#include "clients/bridges/common/peer_loop.h"
#include "clients/bridges/finroc/board.h"
#include "clients/bridges/finroc/bytes.h"
#include "clients/bridges/finroc/greeting.h"
#include "clients/bridges/finroc/type_tables.h"

namespace visum::finroc {

inline constexpr std::size_t kMostBatchBytes = 4u << 20;  // of a batch that a peer sends

class Session : public bridge::PeerSession {
 public:
  // `own` is our side's greeting; its flags are answered to those of the peer. The board must outlive this.
  Session(Board& board, Greeting own);

  void receive(std::span<const std::byte> bytes) override;
  void send_due(bridge::Clock::time_point now) override;
  std::string ended() const override { return ended_; }
  std::chrono::milliseconds follows_every() const override { return every_; }

 private:
  enum class State { kGreeting, kItsStructure, kBatches };
  struct Subscription {
    std::int32_t peers_handle = 0;
    Encoding encoding = Encoding::kBinary;
    std::chrono::milliseconds interval{0};
    std::optional<std::uint64_t> sent;  // the revision that was sent last
    bridge::Clock::time_point due{};    // when the next value may be sent
  };

  std::size_t take_one(std::span<const std::byte> bytes);  // returns 0 if more bytes are needed
  std::size_t take_greeting(std::span<const std::byte> bytes);
  void send_structure();
  void take_batch(Reader batch);
  bool take_message(Reader& batch);
  void take_sized(std::uint8_t code, Reader body);
  void subscribe(Reader& in);
  void note_shortest_interval();
  void take_written_value(Reader& body, bool with_times);
  void take_call(Reader& body);
  void take_pull(Reader& in);

  void add_message(std::uint8_t code, int size_bytes, const std::string& body);
  void add_changes();
  void add_value(const Element& element, Subscription& subscription);

  Board& board_;
  const Greeting own_;
  State state_ = State::kGreeting;
  Greeting peer_;
  std::string peer_name_;  // the same for all connections of a peer
  std::string ended_;
  std::vector<std::byte> input_;
  TypesSent types_sent_;
  TypesHeard types_heard_;
  std::size_t changes_sent_ = 0;
  std::map<ElementId, Subscription> subscriptions_;
  std::chrono::milliseconds every_ = kNever;  // the shortest interval of the subscriptions
  std::string messages_;                      // of the next batch
  std::optional<std::int16_t> to_acknowledge_;
};

}  // namespace visum::finroc
