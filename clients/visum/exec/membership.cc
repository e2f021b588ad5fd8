#include "clients/visum/exec/membership.h"

#include <chrono>
#include <cstdio>

#include "clients/visum/common/exit_code.h"
#include "clients/visum/common/terminal.h"

namespace visum::exec {
namespace {

// `next` gives the next of the server's messages, if there is one.
template <typename Next>
std::optional<std::string> find_reason(protocol::Connection& connection, Next next) {
  std::optional<std::string> why;
  while (const auto message = next()) {
    const auto* event = std::get_if<protocol::Event>(&*message);
    if (event && event->kind == "lockstep_timeout") why = event->text;
  }
  if (!why) return why;
  // The event may have named another member; a member may send a note.
  try {
    connection.request(protocol::Note{});
    return std::nullopt;
  } catch (const protocol::RequestError& error) {
    if (error.code() != protocol::ErrorCode::kWrongState) throw;
    return why;
  }
}

}  // namespace

protocol::Advanced join(protocol::Connection& connection, const protocol::Join& request) try {
  if (connection.welcome().clock != "lockstep")
    throw cli::ExitError(cli::kUsage, "the server's clock is " + connection.welcome().clock +
                                          "; for --lockstep and --gate start visumd with --clock lockstep");
  return connection.request_as<protocol::Advanced>(request);
} catch (const protocol::RequestError& error) {
  throw cli::ExitError(cli::kUsage, error.what());
}

void leave(protocol::Connection& connection) try {
  connection.request(protocol::Leave{});
} catch (const protocol::RequestError& error) {
  if (error.code() != protocol::ErrorCode::kWrongState)
    throw;  // removed from the lockstep in the last moment
}

std::optional<std::string> why_thrown_out(protocol::Connection& connection) {
  return find_reason(connection, [&] { return connection.next(std::chrono::milliseconds(0)); });
}

std::optional<std::string> why_thrown_out_by_now(protocol::Connection& connection) {
  return find_reason(connection, [&] { return connection.next_kept(); });
}

void say_dropped(const std::string& why) {
  std::fprintf(stderr, "visum: %s: it goes on in real time (L0), and no run is like another\n",
               cli::printable(why).c_str());
}

}  // namespace visum::exec
