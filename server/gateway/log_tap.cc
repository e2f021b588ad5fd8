#include "server/gateway/log_tap.h"

#include <spdlog/sinks/base_sink.h>
#include <spdlog/spdlog.h>

#include <mutex>
#include <utility>

namespace visum::gateway {
namespace {

protocol::EventLevel level_of(spdlog::level::level_enum level) {
  if (level >= spdlog::level::err) return protocol::EventLevel::kError;
  if (level == spdlog::level::warn) return protocol::EventLevel::kWarning;
  return level == spdlog::level::info ? protocol::EventLevel::kInfo : protocol::EventLevel::kDebug;
}

}  // namespace

struct LogTap::Sink : spdlog::sinks::base_sink<std::mutex> {
  void sink_it_(const spdlog::details::log_msg& line) override {
    if (lines.size() == kMostLines)
      ++dropped;
    else
      lines.push_back({level_of(line.level), {line.payload.data(), line.payload.size()}});
  }
  void flush_() override {}
  std::uint64_t take(std::vector<Line>& to) {
    const std::lock_guard lock(mutex_);
    to = std::exchange(lines, {});
    return std::exchange(dropped, 0);
  }
  std::vector<Line> lines;
  std::uint64_t dropped = 0;
};

LogTap::LogTap() : sink_(std::make_shared<Sink>()) {
  spdlog::default_logger()->sinks().push_back(sink_);
}

LogTap::~LogTap() {
  std::erase(spdlog::default_logger()->sinks(), sink_);
}

std::uint64_t LogTap::take(std::vector<Line>& lines) {
  return sink_->take(lines);
}

}  // namespace visum::gateway
