// Serves the TCP peers of a bridge on one thread. Every count, queue and wait has a bound.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace visum::bridge {

using Clock = std::chrono::steady_clock;

// One peer's session, without its socket: bytes come in, bytes to be sent wait in output(). A test or a
// fuzzer drives it without a network.
class PeerSession {
 public:
  virtual ~PeerSession() = default;
  virtual void receive(std::span<const std::byte> bytes) = 0;
  // Appends what is due to output(). It is not called while the peer is slow to take what waits.
  virtual void send_due(Clock::time_point now) = 0;
  // Why the session has ended; empty while it goes on.
  virtual std::string ended() const = 0;
  // How often the session wants values of the server; kNever while it wants none.
  static constexpr std::chrono::milliseconds kNever = std::chrono::milliseconds::max();
  virtual std::chrono::milliseconds follows_every() const = 0;
  std::string& output() { return output_; }

 private:
  std::string output_;
};

struct PeerLimits {
  std::size_t peers = 32;                       // a further one is closed at once
  std::size_t slow_bytes = 256u << 10;          // above it nothing new is put into the output
  std::size_t most_bytes = 64u << 20;           // above it the peer is closed
  std::chrono::milliseconds stall{10000};       // a peer that takes no bytes for so long is closed
  std::chrono::milliseconds first_bytes{5000};  // a peer that says nothing for so long is closed
};

// A listening socket. Without a port asked for, it takes `usual` or the next free one of the hundred above.
class Door {
 public:
  // Throws cli::ExitError(kUsage) if the address is no address, or the port asked for is taken.
  Door(const std::string& address, int asked_port, std::uint16_t usual);
  ~Door();
  Door(const Door&) = delete;
  Door& operator=(const Door&) = delete;
  int handle() const { return handle_; }
  std::uint16_t port() const { return port_; }

 private:
  int handle_ = -1;
  std::uint16_t port_ = 0;
};

class PeerLoop {
 public:
  using MakeSession = std::function<std::unique_ptr<PeerSession>(const std::string& address)>;

  PeerLoop(Door& door, MakeSession make_session, PeerLimits limits = {});
  ~PeerLoop();

  // Waits for up to `longest`, takes in what peers have sent, and returns.
  void wait(std::chrono::milliseconds longest);
  // Lets the sessions add what is due, and sends it as far as the peers take it.
  void send(Clock::time_point now);
  std::chrono::milliseconds follows_every() const;  // as the most eager session
  std::size_t peers() const { return peers_.size(); }

 private:
  struct Peer;
  void accept_one();
  void hear(Peer& peer);
  void speak(Peer& peer, Clock::time_point now);
  void drop_ended();

  Door& door_;
  const MakeSession make_session_;
  const PeerLimits limits_;
  std::vector<std::unique_ptr<Peer>> peers_;
};

}  // namespace visum::bridge
