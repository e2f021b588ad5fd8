#include "clients/visum/campaign/progress.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <ctime>
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

constexpr const char* kStyle = R"(
:root{color-scheme:light dark;--line:#8886;--good:#1a7f37;--bad:#cf222e;--odd:#9a6700}
@media(prefers-color-scheme:dark){:root{--good:#3fb950;--bad:#f85149;--odd:#d29922}}
body{font:15px/1.45 system-ui,sans-serif;max-width:1100px;margin:2em auto;padding:0 1em}
.bar{height:1.2em;border:1px solid var(--line);border-radius:4px;overflow:hidden;display:flex}
.passed{background:var(--good)}.failed{background:var(--bad)}.invalid{background:var(--odd)}
td{padding:.15em .7em}td:first-child{width:.2em}td.n{text-align:right;font-variant-numeric:tabular-nums}
)";

std::string time_text(double seconds) {
  if (seconds < 90.0) return cli::fixed(seconds, 0) + " s";
  if (seconds < 5400.0) return cli::fixed(seconds / 60.0, 0) + " min";
  return cli::fixed(seconds / 3600.0, 1) + " h";
}

// "18:28:07", in the time of this machine.
std::string clock_now() {
  const std::time_t now = std::time(nullptr);
  std::tm local{};
  ::localtime_r(&now, &local);
  char text[16];
  std::strftime(text, sizeof text, "%H:%M:%S", &local);
  return text;
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

std::string progress_html(const std::string& name, const Progress& progress, double seconds,
                          const std::string& clock) {
  const auto percent = [&](std::size_t runs) {
    return cli::fixed(
        100.0 * static_cast<double>(runs) / static_cast<double>(std::max<std::size_t>(progress.all, 1)), 2);
  };
  const std::size_t good = progress.done - std::min(progress.done, progress.failed + progress.invalid);
  std::string bar, figures;
  const auto add = [&](const char* kind, std::size_t runs) {
    bar += std::string("<i class=\"") + kind + "\" style=\"width:" + percent(runs) + "%\"></i>";
    figures += std::string("<tr><td class=\"") + kind + "\"></td><td>" + kind + "</td><td class=\"n\">" +
               std::to_string(runs) + "</td><td class=\"n\">" + percent(runs) + " %</td></tr>\n";
  };
  add("passed", good);
  add("failed", progress.failed);
  add("invalid", progress.invalid);
  return "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta http-equiv=\"refresh\" "
         "content=\"2\"><meta name=\"viewport\" content=\"width=device-width\"><title>" +
         percent(progress.done) + " % " + cli::markup(name) + "</title><style>" + kStyle +
         "</style></head><body>\n<h1>" + cli::markup(name) +
         "</h1>\n<p class=\"bar\" role=\"progressbar\" "
         "aria-valuemin=\"0\" aria-valuemax=\"100\" aria-valuenow=\"" +
         percent(progress.done) + "\">" + bar + "</p>\n<p><b>" +
         cli::markup(progress_text(progress, seconds)) + "</b></p>\n<table>\n" + figures +
         "</table>\n<p>At work for " + time_text(seconds) + ", as of " + clock +
         ". This page renews itself every 2 s, and becomes the report. If the time stands still for long, "
         "the "
         "campaign was killed: started again, it goes on.</p>\n</body></html>\n";
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
    cli::write_whole_file(folder_ / "report.html", progress_html(name_, progress, seconds, clock_now()));
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
