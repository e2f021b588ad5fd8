#include "clients/visum/campaign/progress.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <stdexcept>
#include <system_error>

#include "clients/visum/common/format.h"
#include "clients/visum/common/json_writer.h"
#include "clients/visum/common/markup.h"
#include "clients/visum/common/whole_file.h"
#include "protocol/config/config.h"

namespace visum::campaign {
namespace {

constexpr const char* kFile = "progress.json";
constexpr std::chrono::seconds kWritten{1};  // at most so often

std::string time_text(double seconds) {
  if (seconds < 90.0) return cli::fixed(seconds, 0) + " s";
  if (seconds < 5400.0) return cli::fixed(seconds / 60.0, 0) + " min";
  return cli::fixed(seconds / 3600.0, 1) + " h";
}

std::string as_json(const Progress& progress) {
  cli::JsonWriter json;
  json.begin_object().member("runs", progress.all).member("done", progress.done);
  json.member("passed", progress.passed).member("failed", progress.failed);
  json.member("invalid", progress.invalid).member("reused", progress.reused);
  return json.end_object().text() + "\n";
}

}  // namespace

std::string progress_text(const Progress& progress, double seconds) {
  std::string text = progress.what + std::to_string(progress.done) + " of " + std::to_string(progress.all) +
                     " runs, " + std::to_string(progress.failed) + " failed, " +
                     std::to_string(progress.invalid) + " invalid";
  if (progress.reused > 0) text += ", " + std::to_string(progress.reused) + " were there already";
  const auto made = static_cast<double>(progress.done - std::min(progress.done, progress.reused));
  if (made == 0.0) return text;
  const double rate = made / std::max(seconds, 1e-3);
  return text + "; " + cli::rounded(rate, 3) + " runs/s, about " +
         time_text(static_cast<double>(progress.all - progress.done) / rate) + " left";
}

std::string progress_html(const std::string& name, const Progress& progress, double seconds) {
  const std::string title = cli::markup(name);
  return "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta http-equiv=\"refresh\" "
         "content=\"2\"><title>" +
         title +
         "</title><style>:root{color-scheme:light dark}body{font:15px/1.45 "
         "system-ui,sans-serif;max-width:1100px;margin:2em auto;padding:0 "
         "1em}progress{width:100%}</style></head>"
         "<body>\n<h1>" +
         title + "</h1>\n<p><progress max=\"" + std::to_string(std::max<std::size_t>(progress.all, 1)) +
         "\" value=\"" + std::to_string(progress.done) + "\"></progress></p>\n<p>" +
         cli::markup(progress_text(progress, seconds)) + "</p>\n<p>Since " + time_text(seconds) +
         ". This page renews itself, and becomes the report.</p>\n</body></html>\n";
}

std::optional<Progress> read_progress(const std::filesystem::path& folder) {
  for (const char* name : {kFile, "summary.json"}) {
    std::error_code none;
    if (!std::filesystem::exists(folder / name, none)) continue;
    try {
      const auto told = config::load_file(folder / name);
      const auto count = [&](const char* key) { return static_cast<std::size_t>(told.get(key).integer(0)); };
      Progress progress;
      progress.all = count("runs");
      progress.done = told.find("done") ? count("done") : progress.all;
      progress.passed = count("passed");
      progress.failed = count("failed");
      progress.invalid = count("invalid");
      progress.reused = count("reused");
      return progress;
    } catch (const config::ConfigError&) {  // it is being replaced just now
    }
  }
  return std::nullopt;
}

ProgressBoard::ProgressBoard(std::filesystem::path folder, std::string name)
    : folder_(std::move(folder)), name_(std::move(name)), terminal_(::isatty(STDERR_FILENO) != 0) {}

void ProgressBoard::show(const Progress& progress) {
  if (progress.what != what_) {
    what_ = progress.what;
    began_ = Clock::now();
    written_.reset();
  }
  const auto now = Clock::now();
  const double seconds = std::chrono::duration<double>(now - began_).count();
  if (!written_ || now - *written_ >= kWritten) {
    written_ = now;
    write(progress, seconds);
  }
  const auto period = std::chrono::milliseconds(terminal_ ? 200 : 10'000);
  const auto since = told_.value_or(began_);
  if (now - since < period && progress.done != progress.all) return;
  told_ = now;
  std::fprintf(stderr, terminal_ ? "\r\033[K%s" : "%s\n", progress_text(progress, seconds).c_str());
  std::fflush(stderr);
}

// Progress that cannot be written costs no run.
void ProgressBoard::write(const Progress& progress, double seconds) const {
  try {
    cli::write_whole_file(folder_ / "report.html", progress_html(name_, progress, seconds));
    cli::write_whole_file(folder_ / kFile, as_json(progress));
  } catch (const std::runtime_error&) {
  }
}

void ProgressBoard::end() {
  if (terminal_) std::fputs("\r\033[K", stderr);
  std::error_code none;
  std::filesystem::remove(folder_ / kFile, none);
}

}  // namespace visum::campaign
