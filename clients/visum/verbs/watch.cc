#include <algorithm>
#include <cstdio>

#include "clients/visum/common/exit_code.h"
#include "clients/visum/common/format.h"
#include "clients/visum/common/interrupt.h"
#include "clients/visum/common/ports.h"
#include "clients/visum/common/samples.h"
#include "clients/visum/common/terminal.h"
#include "clients/visum/verbs/verbs.h"

namespace visum::cli {
namespace {

using protocol::PartSample;

// A table that is drawn over itself. It is cut to the terminal's rows, because the cursor cannot go back to
// lines that have scrolled away.
class LiveTable {
 public:
  LiveTable() { std::fputs("\033[?25l", stdout); }  // hides the cursor
  ~LiveTable() { std::fputs("\033[?25h", stdout); }
  LiveTable(const LiveTable&) = delete;
  LiveTable& operator=(const LiveTable&) = delete;

  void draw(const std::string& whole) {
    const std::string text = cut_to_rows(whole, rows_of(stdout));
    if (lines_ > 0) std::printf("\033[%ldA", lines_);
    std::string cleared;
    for (const char c : text) cleared += c == '\n' ? std::string("\033[K\n") : std::string(1, c);
    std::fputs((cleared + "\033[J").c_str(), stdout);
    std::fflush(stdout);
    lines_ = std::count(text.begin(), text.end(), '\n');
  }

 private:
  long lines_ = 0;
};

class Watch : public Verb {
 public:
  void declare(CLI::App& app) override {
    app.add_option("PART", part_, "the part's name")->required();
    app.add_option("PORT", ports_, "ports or groups by name; default: all");
    add_link_options(app, link_);
    app.add_option("--every", every_ms_, "simulated milliseconds between samples")
        ->capture_default_str()
        ->check(number_within(1e-3, 1e9));
    app.add_option("--count", count_, "end after this many samples; 0: at Ctrl-C")
        ->check(CLI::NonNegativeNumber);
    app.footer(
        "On a terminal it shows a live table. Into a file or a pipe it writes a line per "
        "sample.\n\nExamples:\n"
        "  visum watch arm \"Actual Angle\"\n  visum watch arm \"Part State\" --every 10 --count 100 --json");
  }

  int run() override {
    auto link = open_link(link_, protocol::Role::kObserver);
    const auto reply = describe_part(link, part_);
    const auto ports = find_ports(reply.description, ports_);
    const double ticks = every_ms_ * 1e6 / static_cast<double>(link.welcome().tick_ns);
    catch_interrupts();
    link.request(protocol::Subscribe{part_, static_cast<std::uint32_t>(std::clamp(ticks, 1.0, 4e9))});
    if (!link_.json && is_terminal(stdout)) {
      LiveTable table;
      return follow(link, [&](const PartSample& sample) {
        table.draw(heading(link, sample) + sample_table(sample, ports));
      });
    }
    return follow(link, [&](const PartSample& sample) {
      std::puts((link_.json ? sample_json(sample, ports) : sample_line(sample, ports)).c_str());
      std::fflush(stdout);
    });
  }

 private:
  // Calls show(sample) for each sample, until --count, Ctrl-C, or nobody reads our output any more.
  int follow(protocol::Connection& link, auto&& show) const {
    for (std::int64_t seen = 0; count_ == 0 || seen < count_;) {
      const auto message = link.next(std::chrono::milliseconds(100));
      if (interrupted()) return kInterrupted;
      if (!message) continue;
      if (const auto* sample = std::get_if<PartSample>(&*message)) {
        show(*sample);
        ++seen;
      }
      if (std::ferror(stdout)) return kDone;  // nobody reads any more
    }
    return kDone;
  }

  std::string heading(const protocol::Connection& link, const PartSample& sample) const {
    const Style style(stdout);
    const std::string sign = link.welcome().simulated ? "VIRTUAL" : "REAL";
    std::string text = style.bold(sign) + "  " + part_ + " at " + seconds(sample.sim_time_ns) + ", tick " +
                       std::to_string(sample.tick);
    if (sample.conflated > 0) text += style.dim(", " + std::to_string(sample.conflated) + " samples skipped");
    return text + "\n";
  }

  LinkOptions link_;
  std::string part_;
  std::vector<std::string> ports_;
  double every_ms_ = 100.0;
  std::int64_t count_ = 0;
};

}  // namespace

std::unique_ptr<Verb> make_watch() {
  return std::make_unique<Watch>();
}

}  // namespace visum::cli
