// The daemon: a simulation, the sessions in front of it, and the loop that runs both.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "protocol/config/profile.h"
#include "protocol/tls.h"
#include "server/bus/address.h"
#include "server/cycle/simulation.h"
#include "server/gateway/access.h"
#include "server/gateway/stuck_node.h"

namespace visum::recording {
class Archive;
class FlightRecorder;
}  // namespace visum::recording

namespace visum::gateway {

class DaemonLoop;
class LogTap;
class Playback;
struct Published;

struct HttpOptions {
  bool on = false;
  std::uint16_t port = 8080;       // 0: any free one
  bool any_if_taken = false;       // if another program has that port, take any free one
  std::string page;                // its folder; empty: none, only /healthz, /metrics and sessions
  std::vector<std::string> hosts;  // further names under which clients reach this machine
};

struct DaemonOptions {
  std::string program = "visumd";  // its name for clients
  std::string address = "127.0.0.1";
  std::uint16_t port = 1500;
  bool run_at_once = false;  // else time starts with the first lease, the first step of a member, or resume
  std::int64_t iterations = 0;         // ends after so many ticks; 0: never
  std::string token_file;              // needed where the address is not loopback
  protocol::TlsFiles tls;              // none: plain text
  std::vector<bus::BusAddress> buses;  // beside those of the scene
  bool paced = false;  // lockstep too is no faster than the scene's speed; else as fast as its members let it
  HttpOptions http;
  std::function<StuckNode()> stuck_node;  // which call of a plug-in hangs; any thread. Empty: nobody watches
  // Clock realtime: parts that sessions command are stopped once the sessions' thread has been silent for so
  // long, and writes that have become older than this are dropped. 0: never.
  std::chrono::milliseconds session_silence{250};
  std::chrono::milliseconds command_age{200};
  // Clock realtime: the tick's thread runs by SCHED_FIFO with this priority, so that no ordinary program of
  // this machine delays it; 0: it is an ordinary thread.
  int realtime_priority = 0;
  // Called, on another thread than run()'s, where the daemon is to end and a tick has not ended for two
  // seconds: the sessions are closed, nothing records that tick, and run() will never return. It must end the
  // process. `what` says what the tick was doing. Empty: the daemon waits for each tick.
  std::function<void(const std::string& what)> abandoned;
  // Parts in front of something real.
  bool simulated = true;  // what the welcome says
  bool has_world = true;  // false: nobody may hold the time, go back in it, or change bodies
  // On the tick's thread, before each tick: in clock realtime instead of sleeping until it is due, or for a
  // piece of that.
  std::function<void(std::chrono::steady_clock::time_point)> wait;
  const recording::FlightRecorder* flight = nullptr;  // writes down how it froze; must outlive the daemon
  LogTap* log = nullptr;                              // the log's lines for clients; null: they hear of none
  std::filesystem::path models;  // folder of the installation's models, scenes and scenarios; empty: none
  cycle::SceneOrder scenes;      // how those scenes are read that clients load, without a file
  recording::Archive* archive = nullptr;  // named snapshots and recordings; null: there are none
  config::Profile* profile = nullptr;     // measures the tick's thread; must outlive the daemon
  Playback* playback = nullptr;           // a recording, whose world this is; must outlive the daemon
  // On the tick's thread, at each copy of the world for the sessions: puts another server's world into it.
  std::function<void(Published&)> show;
};

// Made and run on one thread. In clock realtime the sessions have a thread of their own, and the tick never
// waits for them. In lockstep and free both share the caller's thread, so that no step pays for waking
// another thread. run() passes on what a tick throws.
class Daemon {
 public:
  // Opens the buses and binds the port; clients that connect from now on are served once run() is called.
  // Throws ConfigError (token file), std::runtime_error (address in use, an address beyond loopback without a
  // token file, ...).
  Daemon(cycle::Simulation& simulation, const DaemonOptions& options);
  ~Daemon();

  std::uint16_t port() const;
  const bus::BusNames& buses() const;  // the open ones
  std::uint16_t http_port() const;     // 0: off
  // Until stop(), a client's Shutdown, or `iterations` ticks.
  void run();
  // Any thread, and signal handlers: the current tick is finished, replies are flushed, run() returns.
  void stop() { stopping_.store(true, std::memory_order_relaxed); }

 private:
  std::atomic<bool> stopping_{false};
  std::unique_ptr<DaemonLoop> loop_;
};

}  // namespace visum::gateway
