// Tells of each check of a run once, as soon as its result is certain: a check that must always hold fails at
// its first violation, one that must hold once passes when it does, others wait for the end. Main thread; the
// runner owns it.
#pragma once

#include <functional>
#include <utility>
#include <vector>

#include "clients/visum/run/check.h"

namespace visum::run {

class CheckNews {
 public:
  using Tell = std::function<void(const CheckResult&)>;
  explicit CheckNews(Tell tell) : tell_(std::move(tell)) {}

  // After each step. The checks are the same ones in each call.
  void look(const std::vector<Check>& checks, double now_s);
  // At the end: tells of those that have not been told.
  void finish(const std::vector<CheckResult>& results);

 private:
  Tell tell_;
  std::vector<bool> told_;
};

}  // namespace visum::run
