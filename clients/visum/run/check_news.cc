#include "clients/visum/run/check_news.h"

namespace visum::run {

void CheckNews::look(const std::vector<Check>& checks, double now_s) {
  told_.resize(checks.size());
  for (std::size_t i = 0; i < checks.size(); ++i) {
    if (told_[i] || !checks[i].is_certain(now_s)) continue;
    told_[i] = true;
    tell_(checks[i].result());
  }
}

void CheckNews::finish(const std::vector<CheckResult>& results) {
  told_.resize(results.size());
  for (std::size_t i = 0; i < results.size(); ++i)
    if (!told_[i]) tell_(results[i]);
  told_.assign(results.size(), true);
}

}  // namespace visum::run
