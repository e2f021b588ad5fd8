#include "server/programs/logbook.h"

#include <spdlog/spdlog.h>

#include <exception>

namespace visum::programs {

Logbook::Logbook(cycle::Simulation& simulation, const recording::Origin& origin, const std::string& needed,
                 const std::string& tried, recording::LogSink& log)
    : log_(log), needed_(!needed.empty()) {
  try {
    recorder_.emplace(simulation, origin, needed_ ? needed : tried);
    log_.follow(&*recorder_);
  } catch (const std::exception& error) {
    if (needed_) throw;
    spdlog::warn("{}", error.what());
  }
}

Logbook::~Logbook() {
  log_.follow(nullptr);
}

bool Logbook::close() {
  log_.follow(nullptr);
  if (recorder_) recorder_->end();
  return !recorder_ || recorder_->close() || !needed_;
}

}  // namespace visum::programs
