#include "clients/visum/run/announcements.h"

#include "protocol/config/printable.h"

namespace visum::run {
namespace {

constexpr std::size_t kMostAnnounced = 1000;  // bytes: SPEC.md, section 9

}  // namespace

void Announcements::add(const std::string& text, const std::string& kind, protocol::EventLevel level) {
  if (waiting_.size() == kMost)
    ++left_out_;
  else
    waiting_.push_back({config::shortened(config::printable(text), kMostAnnounced), kind, level});
}

void Announcements::add_line(const std::string& who, const std::string& line) {
  add(who + ": " + line, "line", protocol::EventLevel::kInfo);
}

void Announcements::add_check(const CheckResult& check) {
  add(check.name + (check.passed ? ": passed" : ": failed, " + check.failure), "check",
      check.passed ? protocol::EventLevel::kInfo : protocol::EventLevel::kError);
}

void Announcements::flush(Session& session) {
  if (session.steps_ahead() != 0) return;
  if (left_out_ != 0)
    waiting_.push_back(
        {std::to_string(left_out_) + " further lines were left out", "line", protocol::EventLevel::kWarning});
  for (const auto& announcement : waiting_) session.post(announcement);
  waiting_.clear();
  left_out_ = 0;
}

}  // namespace visum::run
