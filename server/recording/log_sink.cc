#include "server/recording/log_sink.h"

#include <spdlog/sinks/base_sink.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <mutex>

namespace visum::recording {

struct LogSink::Sink : spdlog::sinks::base_sink<std::mutex> {
  explicit Sink(Recorder& recorder) : recorder_(recorder) {}
  void sink_it_(const spdlog::details::log_msg& line) override {
    const auto level = spdlog::level::to_string_view(line.level);
    recorder_.log({level.data(), level.size()}, {line.payload.data(), line.payload.size()});
  }
  void flush_() override {}
  Recorder& recorder_;
};

LogSink::LogSink(Recorder& recorder) : sink_(std::make_shared<Sink>(recorder)) {
  spdlog::default_logger()->sinks().push_back(sink_);
}

LogSink::~LogSink() {
  std::erase(spdlog::default_logger()->sinks(), sink_);
}

}  // namespace visum::recording
