#include "protocol/client_log.h"

#include <spdlog/spdlog.h>

#include <utility>

namespace visum::protocol {
namespace {

LineLimit::Time now() {
  return LineLimit::Time::clock::now();
}

spdlog::level::level_enum spdlog_level(LogLevel level) {
  if (level == LogLevel::kDebug) return spdlog::level::debug;
  return level == LogLevel::kWarning ? spdlog::level::warn : spdlog::level::err;
}

void tell(const std::string& who, std::uint64_t left_out) {
  if (left_out > 0) spdlog::warn("{}: {} further lines were left out", who, left_out);
}

}  // namespace

bool LineLimit::allows(Time now) {
  const bool allowed = lines_.take(now);
  if (!allowed && left_out_++ == 0) told_at_ = now;
  return allowed;
}

std::uint64_t LineLimit::take_left_out(Time now) {
  if (now - told_at_ < std::chrono::seconds(1)) return 0;
  told_at_ = now;
  return take_rest();
}

std::uint64_t LineLimit::take_rest() {
  return std::exchange(left_out_, 0);
}

ClientLog::ClientLog(std::string who) : who_(std::move(who)), limit_(now()) {}

ClientLog::~ClientLog() {
  tell(who_, limit_.take_rest());
}

void ClientLog::write(LogLevel level, const std::string& text) {
  if (!spdlog::should_log(spdlog_level(level))) return;
  sweep();
  if (limit_.allows(now())) spdlog::log(spdlog_level(level), "{}", text);
}

void ClientLog::sweep() {
  tell(who_, limit_.take_left_out(now()));
}

bool ClientLog::is_idle() const {
  return limit_.is_idle(now());
}

ClientLog& AddressLogs::of(const std::string& peer) {
  const std::string address = peer.substr(0, peer.rfind(':'));
  const auto known = logs_.find(address);
  if (known != logs_.end()) return known->second;
  if (logs_.size() >= kMaxAddresses)
    std::erase_if(logs_, [](const auto& log) { return log.second.is_idle(); });
  if (logs_.size() >= kMaxAddresses) return others_;
  return logs_.try_emplace(address, "clients at " + address).first->second;
}

void AddressLogs::sweep() {
  for (auto& [address, log] : logs_) log.sweep();
  others_.sweep();
}

}  // namespace visum::protocol
