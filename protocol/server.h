// The server's end of sessions, over TCP or WebSocket: listening, framing, hello, deadlines, bounded queues.
// The handler (server/gateway) decides what a request means. Boost.Asio and Beast stay inside this folder.
//
// Threads: everything happens on the one thread that calls run() or poll(), the calls of the handler
// included. Only stop() and notify() may be called from any thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "protocol/client_log.h"
#include "protocol/limits.h"
#include "protocol/messages.h"
#include "protocol/tls.h"
#include "protocol/web_pages.h"

namespace visum::protocol {

enum class CloseReason {
  kGoodbye,  // the peer closed its side between two frames
  kLost,     // reset, cut inside a frame, keepalive failed, stalled
  kRefused,  // we closed it: bad frame, bad hello, or a limit
  kShutdown,
};

// One client. The server owns it; it is valid until on_close() has returned.
class Session {
 public:
  virtual ~Session() = default;
  virtual std::uint64_t id() const = 0;
  virtual const std::string& client_name() const = 0;  // "" before hello
  virtual const std::string& peer() const = 0;         // "127.0.0.1:43210", or "a Unix socket"
  virtual Role role() const = 0;
  // The bytes in the frame of the request that is being handled, without the length in front.
  virtual std::size_t request_bytes() const = 0;
  // The name in the certificate that the client showed; "" if it showed none.
  virtual std::string identity() const { return {}; }

  // Queues a reply, or an event (`reply_to` 0). They keep their order and are never dropped. If too many
  // events wait, the session is closed instead. A handler that answers requests later must check behind()
  // before each answer.
  virtual void send(std::uint64_t reply_to, const Reply& reply) = 0;
  // True if so much waits to be written that the handler must not answer requests until on_room() is called.
  virtual bool behind() const = 0;
  // Queues a sample, in place of an unsent one of the same stream. Returns false if it replaced one.
  virtual bool send_latest(std::uint32_t stream, const Reply& sample) = 0;
  // True while no sample of this stream waits to be written. If false, the sender can save itself the
  // encoding.
  virtual bool ready_for(std::uint32_t stream) const = 0;
  // While on, replies may wait for those that follow, so that all leave together. They leave after
  // Limits::longest_hold_back in any case, once the server has waited for a millisecond in vain, with the
  // next sample or event, and if the session is behind().
  virtual void hold_back(bool) {}
  // Writes a line about this client to the log, at most 20 a second (client_log.h). Clients that have not
  // said Hello share that with all others from their address.
  virtual void log(LogLevel level, const std::string& text) = 0;
  // Sends what is queued, then closes.
  virtual void close(CloseReason reason) = 0;
};

// Receives what clients send. All calls come on the server's thread. The handler must outlive the server. An
// exception from a call closes that session with an internal error; the server goes on.
class SessionHandler {
 public:
  virtual ~SessionHandler() = default;
  // Called when a Hello with good version, role and name arrived. The handler checks the token and fills what
  // Welcome says about the world. Returns the granted role, or kUnspecified with `refusal` filled. It must
  // not send: Welcome is the session's first message.
  virtual Role on_hello(Session& session, const Hello& hello, Welcome& welcome, Error& refusal) = 0;
  virtual void on_request(Session& session, std::uint64_t id, const Request& request) = 0;
  virtual void on_close(Session& session, CloseReason reason) = 0;  // only if on_hello() granted a role
  virtual void on_notify() = 0;                                     // soon after notify()
  // Bytes came, which are handled next. For a profile: until now the server may have waited for them.
  virtual void on_bytes() {}
  // Enough was written that the session is no longer behind(). Called before the session's next request.
  virtual void on_room(Session&) {}
};

// Where to listen, and for whom.
struct ListenOptions {
  std::string address = "127.0.0.1";
  std::uint16_t port = kDefaultPort;  // 0: any free port
  Limits limits;
  WebOptions web;  // the HTTP port: sessions over WebSocket, and pages
  TlsFiles tls;    // none: plain text; otherwise TLS on both ports
};

// Listens and owns all sessions. Owned by the gateway's Daemon.
class Server {
 public:
  // Binds and listens, but accepts nothing yet. Throws std::runtime_error with address and port if that
  // fails.
  Server(const ListenOptions& options, SessionHandler& handler);
  ~Server();  // cuts the remaining sessions off without telling the handler

  std::uint16_t port() const;
  std::uint16_t http_port() const;  // 0: no HTTP
  void start();                     // begins to accept
  void run();                       // returns after stop(); for a thread of its own (clock realtime)
  // Handles what is ready, bounded. True if there was anything. Writes as write() does.
  bool poll();
  void write();  // sends what is queued and not held back; reads nothing
  // Waits until something is ready and handles it. The wait is rounded up to whole milliseconds.
  void poll_for(std::chrono::nanoseconds at_most);
  // Closes all sessions once their queued replies are sent. Any thread. run() then returns; a caller of
  // poll() goes on until ended().
  void stop();
  // True if the server was stopped and every session is closed. On the server's thread.
  bool ended() const;
  void notify();  // makes on_notify() be called soon; any thread, no lock, no allocation
  std::size_t session_count() const;
  std::uint64_t refused() const;  // frames and sessions refused since start

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace visum::protocol
