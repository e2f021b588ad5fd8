#include "clients/visum/run/progress.h"

#include <sys/ioctl.h>

#include "clients/visum/common/format.h"
#include "clients/visum/common/terminal.h"
#include "clients/visum/common/utf8.h"

namespace visum::run {
namespace {

constexpr std::chrono::milliseconds kTerminalPeriod{100};
constexpr std::chrono::seconds kFilePeriod{5};

// Columns of the terminal; 80 for a file.
std::size_t terminal_width(std::FILE* stream) {
  winsize size{};
  const bool known = ::ioctl(::fileno(stream), TIOCGWINSZ, &size) == 0 && size.ws_col > 0;
  return known ? size.ws_col : 80;
}

}  // namespace

Progress::Progress(bool wanted, std::FILE* stream)
    : stream_(stream), wanted_(wanted), live_(wanted && cli::is_terminal(stream)) {}

void Progress::line(const std::string& who, const std::string& text) {
  const std::string clean = cli::printable(text);
  const bool is_controller = who != "visumd" && who != "scenario";
  if (is_controller) phase_ = clean;
  if (live_ && is_controller) return;
  finish();
  std::fprintf(stderr, "%s | %s\n", who.c_str(), clean.c_str());
}

void Progress::step(double sim_s) {
  if (!wanted_) return;
  const auto now = Clock::now();
  if (!began_) {
    began_ = true;
    begin_ = due_ = now;
  }
  if (now < due_) return;
  due_ = now + (live_ ? Clock::duration(kTerminalPeriod) : Clock::duration(kFilePeriod));
  draw(sim_s, now);
}

void Progress::draw(double sim_s, Clock::time_point now) {
  const double wall_s = std::chrono::duration<double>(now - begin_).count();
  std::string text = cli::fixed(sim_s, 2) + " s";
  if (wall_s > 0.05) text += "  x" + cli::fixed(sim_s / wall_s, 1);
  if (!phase_.empty()) text += "  " + phase_;
  text.resize(std::min(text.size(), terminal_width(stream_) - 1));
  if (!live_) {
    std::fprintf(stderr, "%s\n", cli::valid_utf8(text).c_str());
    return;
  }
  std::fprintf(stream_, "\r\033[K%s", text.c_str());
  std::fflush(stream_);
  shown_ = true;
}

void Progress::finish() {
  if (!shown_) return;
  std::fputs("\r\033[K", stream_);
  std::fflush(stream_);
  shown_ = false;
}

}  // namespace visum::run
