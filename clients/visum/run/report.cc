#include "clients/visum/run/report.h"

namespace visum::run {

std::string swept_text(const Report& report) {
  std::string text;
  for (const auto& [name, value] : report.swept) text += (text.empty() ? "" : ", ") + name + "=" + value;
  return text;
}

std::string title(const Report& report) {
  if (report.run == 0) return report.name;
  return report.name + " [run " + std::to_string(report.run) + ": " + swept_text(report) + "]";
}

}  // namespace visum::run
