// The server's end of the session, over TCP or WebSocket: listening, framing, hello, deadlines, bounded
// queues. What a request means is the handler's business (server/gateway). Boost.Asio and Beast stay inside
// this folder.
//
// Threads: everything, the handler's calls included, happens on the one thread that calls run() or poll().
// stop() and notify() may be called from any thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "protocol/limits.h"
#include "protocol/messages.h"
#include "protocol/tls.h"
#include "protocol/web_pages.h"

namespace visum::protocol {

enum class CloseReason {
  kGoodbye,  // the peer closed its side between two frames
  kLost,     // reset, cut inside a frame, keepalive failed, stalled
  kRefused,  // we closed it: bad frame, bad hello, limits
  kShutdown,
};

// One client. Owned by the server; valid until on_close returned.
class Session {
 public:
  virtual ~Session() = default;
  virtual std::uint64_t id() const = 0;
  virtual const std::string& client_name() const = 0;  // "" before hello
  virtual const std::string& peer() const = 0;         // "127.0.0.1:43210"
  virtual Role role() const = 0;
  // The name in the certificate that the client showed; "": it showed none.
  virtual std::string identity() const { return {}; }

  // Queues a reply or an event; in order, never dropped. The session is closed over the limit of events
  // (`reply_to` 0). Who answers requests later than they came looks at behind() first.
  virtual void send(std::uint64_t reply_to, const Reply& reply) = 0;
  // So much waits to be written that no request is to be answered until the handler's on_room().
  virtual bool behind() const = 0;
  // Queues a sample; an unsent one of the same stream is replaced. Returns false where one was replaced.
  virtual bool send_latest(std::uint32_t stream, const Reply& sample) = 0;
  // True while no sample of this stream waits to be written: a sender may spare itself the encoding.
  virtual bool ready_for(std::uint32_t stream) const = 0;
  // What is queued by now may leave together with what follows it: at the server's next poll() at the latest.
  virtual void hold() {}
  // Sends what is queued, then closes.
  virtual void close(CloseReason reason) = 0;
};

class SessionHandler {
 public:
  virtual ~SessionHandler() = default;
  // Hello is in, its version, role and name are good; the token is the handler's to judge. Fills what Welcome
  // tells of the world. Returns the granted role, or kUnspecified with `refusal` filled. Sends nothing:
  // Welcome comes first.
  virtual Role on_hello(Session& session, const Hello& hello, Welcome& welcome, Error& refusal) = 0;
  virtual void on_request(Session& session, std::uint64_t id, const Request& request) = 0;
  virtual void on_close(Session& session, CloseReason reason) = 0;  // only after on_hello granted a role
  virtual void on_notify() = 0;                                     // some time after notify()
  // What made the session be behind() has been written. Comes before the next of its requests.
  virtual void on_room(Session&) {}
};

struct ListenOptions {
  std::string address = "127.0.0.1";
  std::uint16_t port = kDefaultPort;  // 0: any free one
  Limits limits;
  WebOptions web;  // sessions over WebSocket, and pages, on a port of their own
  TlsFiles tls;    // none: plain text; else TLS on both ports
};

class Server {
 public:
  // Binds and listens, accepts nothing yet. Throws std::runtime_error naming address and port where that
  // fails.
  Server(const ListenOptions& options, SessionHandler& handler);
  ~Server();  // cuts off what is left, without a word to the handler

  std::uint16_t port() const;
  std::uint16_t http_port() const;  // 0: there is no HTTP
  void start();                     // begins to accept
  void run();                       // until stop(); on a thread of its own (clock realtime)
  bool poll();                      // handles what is ready, bounded; true if there was anything
  void write();                     // sends what is queued, and reads nothing
  // Waits for something to be ready, handles it. The wait is rounded up to whole milliseconds.
  void poll_for(std::chrono::nanoseconds at_most);
  void stop();         // closes sessions after their queued replies; any thread. run() returns
                       // then; who polls goes on until ended()
  bool ended() const;  // stopped, and every session is closed; the server's thread
  void notify();       // makes on_notify() be called soon; any thread, no lock, no allocation
  std::size_t session_count() const;
  std::uint64_t refused() const;  // frames and sessions refused since start

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace visum::protocol
