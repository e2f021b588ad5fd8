// Accepted connections that wait to be handed on. They leave one address after the other, and those of one
// address in the order in which they came. If the line is full, the address with the most of them loses its
// newest. Owned by the Listener. Internal to the server; knows Asio.
#pragma once

#include <boost/asio/ip/tcp.hpp>
#include <cstddef>
#include <deque>
#include <map>
#include <utility>

namespace visum::protocol {

// Stands for all addresses that one client has at hand: IPv6 is given out in networks of 64 bits.
boost::asio::ip::address share_of(const boost::asio::ip::address& address);

class AcceptLine {
 public:
  using Socket = boost::asio::ip::tcp::socket;
  using Endpoint = boost::asio::ip::tcp::endpoint;

  static constexpr std::size_t kMaxWaiting = 128;

  // Returns false if a connection, this or another, was dropped for it.
  bool add(Socket socket, const Endpoint& peer);
  bool empty() const { return waiting_ == 0; }
  // The next one. The line must not be empty.
  std::pair<Socket, Endpoint> take();
  void clear();

 private:
  using Waiting = std::map<boost::asio::ip::address, std::deque<std::pair<Socket, Endpoint>>>;

  void drop_newest_of_busiest();

  Waiting by_share_;               // no queue is empty
  boost::asio::ip::address last_;  // was served last
  std::size_t waiting_ = 0;
};

}  // namespace visum::protocol
