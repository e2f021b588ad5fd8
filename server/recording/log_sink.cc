#include "server/recording/log_sink.h"

#include <spdlog/sinks/base_sink.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <mutex>

namespace visum::recording {

struct LogSink::Sink : spdlog::sinks::base_sink<std::mutex> {
  void sink_it_(const spdlog::details::log_msg& line) override {
    if (!recorder_) return;
    const auto level = spdlog::level::to_string_view(line.level);
    recorder_->log({level.data(), level.size()}, {line.payload.data(), line.payload.size()});
  }
  void flush_() override {}
  void follow(Recorder* recorder) {
    const std::lock_guard lock(mutex_);
    recorder_ = recorder;
  }
  Recorder* recorder_ = nullptr;
};

LogSink::LogSink() : sink_(std::make_shared<Sink>()) {
  spdlog::default_logger()->sinks().push_back(sink_);
}

LogSink::~LogSink() {
  std::erase(spdlog::default_logger()->sinks(), sink_);
}

void LogSink::follow(Recorder* recorder) {
  sink_->follow(recorder);
}

}  // namespace visum::recording
