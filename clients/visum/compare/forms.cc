#include "clients/visum/compare/forms.h"

#include <algorithm>
#include <cmath>

#include "clients/visum/common/format.h"
#include "clients/visum/common/json_writer.h"
#include "clients/visum/common/markup.h"
#include "clients/visum/common/shell_word.h"
#include "clients/visum/compare/courses.h"

namespace visum::compare {
namespace {

using cli::JsonWriter;
using cli::markup;

constexpr std::size_t kShownPorts = 20, kShownRuns = 20;  // as text
constexpr std::size_t kDrawnPorts = 12;
constexpr std::size_t kListedRuns = 200;  // on the page

constexpr const char* kStyle = R"(
:root{color-scheme:light dark;--line:#8886;--good:#1a7f37;--bad:#cf222e}
@media(prefers-color-scheme:dark){:root{--good:#3fb950;--bad:#f85149}}
body{font:15px/1.45 system-ui,sans-serif;max-width:1100px;margin:2em auto;padding:0 1em}
table{border-collapse:collapse;margin:1em 0;display:block;overflow-x:auto}
th,td{text-align:left;padding:.25em .7em;border-bottom:1px solid var(--line)}
td{vertical-align:top}code{font-size:13px}td+td{font-variant-numeric:tabular-nums}.good{color:var(--good)}.bad{color:var(--bad)}
)";

std::string number(double value) {
  return cli::rounded(value, 6);
}
std::string number(const std::optional<double>& value) {
  return value ? number(*value) : "-";
}
std::string number(std::uint64_t value) {
  return std::to_string(value);
}

void write_texts(JsonWriter& json, const char* name, const std::vector<std::string>& texts) {
  json.key(name).begin_array();
  for (const auto& text : texts) json.value(text);
  json.end_array();
}

void write_number(JsonWriter& json, const char* name, const std::optional<double>& value) {
  json.key(name);
  value ? json.value(*value) : json.null();
}

void write_check(JsonWriter& json, const CheckComparison& check) {
  json.begin_object().member("check", check.check).member("unit", check.unit).member("both", check.both);
  json.member("only_a", check.only_a).member("only_b", check.only_b).member("neither", check.neither);
  json.member("p", check.p);
  write_number(json, "mean_difference", check.mean);
  write_number(json, "low", check.low);
  write_number(json, "high", check.high);
  json.member("max_abs", check.max_abs).member("max_run", check.max_run).end_object();
}

std::string first_words(const RecordingComparison& of) {
  if (of.equal) return "equal: all " + number(of.ticks_a) + " ticks";
  if (!of.first_tick && of.only_a.empty() && of.only_b.empty())
    return "not the same files of the scene; all " + number(of.ticks_a) + " ticks are equal";
  if (!of.first_tick) return "not the same ports; those that both have are equal in all ticks";
  std::string text = "they part at tick " + std::to_string(*of.first_tick);
  if (of.ticks_a != of.ticks_b) text += "; A has " + number(of.ticks_a) + " ticks, B " + number(of.ticks_b);
  if (of.ports.empty()) text += "; no port differs, but the state does";
  return text;
}

std::string first_words(const CampaignComparison& of) {
  std::string text =
      of.equal ? "equal: all " + number(of.runs) + " runs, bit for bit"
               : number(of.different_count) + " of " + number(of.runs) + " common runs end differently";
  if (of.turned_count > 0) text += ", " + number(of.turned_count) + " of them with another verdict";
  if (of.only_a + of.only_b > 0)
    text += "; " + number(of.only_a) + " are in A only, " + number(of.only_b) + " in B only";
  if (of.invalid > 0) text += "; " + number(of.invalid) + " are invalid and do not count below";
  return text;
}

// Rows of cells, the first of them the head.
using Cells = std::vector<std::vector<std::string>>;

Cells ports_of(const RecordingComparison& of, std::size_t most) {
  Cells cells{{"port", "from tick", "A", "B", "at most apart", "at tick"}};
  for (const auto& port : of.ports) {
    if (cells.size() > most) break;
    cells.push_back({port.port, std::to_string(port.tick), number(port.a), number(port.b),
                     number(port.max_abs), std::to_string(port.max_tick)});
  }
  return cells;
}

Cells checks_of(const CampaignComparison& of) {
  Cells cells{{"check", "unit", "both pass", "only A", "only B", "neither", "p", "B - A", "from", "to",
               "at most", "in run"}};
  const auto add = [&](const CheckComparison& check) {
    const bool measured = check.mean.has_value();
    cells.push_back({check.check, check.unit, number(check.both), number(check.only_a), number(check.only_b),
                     number(check.neither), cli::rounded(check.p, 3), number(check.mean), number(check.low),
                     number(check.high), measured ? number(check.max_abs) : "-",
                     check.max_run != 0 ? number(check.max_run) : "-"});
  };
  add(of.verdict);
  for (const auto& check : of.checks) add(check);
  return cells;
}

// The command that shows where two runs part.
std::string next_step(const RunPair& pair) {
  if (pair.recording_a.empty() || pair.recording_b.empty()) return "-";
  return "visum compare " + cli::shell_word(pair.recording_a) + " " + cli::shell_word(pair.recording_b);
}

Cells runs_of(const CampaignComparison& of, std::size_t most, bool with_commands) {
  Cells cells{{"run", "A", "B", "values"}};
  if (with_commands) cells[0].push_back("where they part");
  for (const auto& pair : of.different) {
    if (cells.size() > most) break;
    cells.push_back({number(pair.run), pair.a, pair.b, pair.values});
    if (with_commands) cells.back().push_back(next_step(pair));
  }
  return cells;
}

std::string text_of(const Cells& cells) {
  if (cells.size() < 2) return {};
  cli::Table table;
  for (const auto& row : cells) table.row(row);
  return table.text();
}

std::string html_of(const Cells& cells) {
  if (cells.size() < 2) return {};
  std::string table = "<table>";
  const char* kind = "th";
  for (const auto& row : cells) {
    table += "<tr>";
    for (const auto& cell : row) table += std::string("<") + kind + ">" + markup(cell) + "</" + kind + ">";
    table += "</tr>\n";
    kind = "td";
  }
  return table + "</table>\n";
}

std::string page(bool equal, const std::string& words, const std::string& a, const std::string& b,
                 const std::string& rest) {
  return std::string(
             "<!doctype html>\n<html lang=\"en\"><head><meta "
             "charset=\"utf-8\"><title>Comparison</title><style>") +
         kStyle + kCoursesStyle + "</style></head><body>\n<h1>Comparison</h1>\n<p>A: <code>" + markup(a) +
         "</code><br>B: <code>" + markup(b) + "</code></p>\n<p><b class=\"" + (equal ? "good" : "bad") +
         "\">" + markup(words) + "</b></p>\n" + rest + "</body></html>\n";
}

// The ports that differ first, in both recordings.
std::string courses_of(const RecordingComparison& of) {
  std::vector<const PortDistance*> ports;
  for (const auto& port : of.ports) ports.push_back(&port);
  std::ranges::stable_sort(ports, {}, &PortDistance::tick);
  std::string html;
  for (std::size_t i = 0; i < std::min(ports.size(), kDrawnPorts); ++i)
    if (const std::string drawn = courses_svg(*ports[i]); !drawn.empty())
      html += "<h3>" + markup(ports[i]->port) + "</h3>\n" + drawn;
  if (html.empty()) return {};
  return "<h2>Side by side</h2>\n<p>A is the whole line, B the dashed one. The " +
         std::to_string(std::min(ports.size(), kDrawnPorts)) + " of " + std::to_string(ports.size()) +
         " ports that part first.</p>\n" + html;
}

std::string list_of(const char* head, const std::vector<std::string>& texts) {
  if (texts.empty()) return {};
  std::string list = std::string("<h2>") + head + "</h2><ul>\n";
  for (const auto& text : texts) list += "<li>" + markup(text) + "</li>\n";
  return list + "</ul>\n";
}

}  // namespace

std::string as_json(const RecordingComparison& of) {
  JsonWriter json;
  json.begin_object().member("equal", of.equal).key("first_tick");
  of.first_tick ? json.value(*of.first_tick) : json.null();
  json.key("ports").begin_array();
  for (const auto& port : of.ports) {
    json.begin_object().member("port", port.port).member("tick", port.tick).member("a", port.a);
    json.member("b", port.b).member("max_abs", port.max_abs).member("max_tick", port.max_tick).end_object();
  }
  json.end_array().key("checks").begin_array().end_array();
  json.member("ticks_a", of.ticks_a).member("ticks_b", of.ticks_b);
  write_texts(json, "only_a", of.only_a);
  write_texts(json, "only_b", of.only_b);
  json.member("same_files", of.same_files);
  write_texts(json, "settings", of.settings);
  return json.end_object().text();
}

std::string as_json(const CampaignComparison& of) {
  JsonWriter json;
  json.begin_object().member("equal", of.equal).key("first_tick").null();
  json.key("ports").begin_array().end_array().key("checks").begin_array();
  write_check(json, of.verdict);
  for (const auto& check : of.checks) write_check(json, check);
  json.end_array().member("runs", of.runs).member("only_a", of.only_a).member("only_b", of.only_b);
  json.member("invalid", of.invalid)
      .member("different_count", of.different_count)
      .key("different")
      .begin_array();
  for (const auto& pair : of.different) json.value(pair.run);
  json.end_array().member("turned_count", of.turned_count).key("turned").begin_array();
  for (const auto& pair : of.different)
    if (pair.turned())
      json.begin_object().member("run", pair.run).member("a", pair.a).member("b", pair.b).end_object();
  json.end_array();
  write_texts(json, "settings", of.settings);
  return json.end_object().text();
}

std::string as_text(const RecordingComparison& of) {
  std::string text = first_words(of) + "\n";
  for (const auto& setting : of.settings) text += "  " + setting + "\n";
  for (const auto& port : of.only_a) text += "  only in A: " + port + "\n";
  for (const auto& port : of.only_b) text += "  only in B: " + port + "\n";
  text += text_of(ports_of(of, kShownPorts));
  if (of.ports.size() > kShownPorts)
    text += "... and " + std::to_string(of.ports.size() - kShownPorts) +
            " more ports; --json and --report have all\n";
  return text;
}

std::string as_text(const CampaignComparison& of) {
  std::string text = first_words(of) + "\n";
  for (const auto& setting : of.settings) text += "  made differently: " + setting + "\n";
  text += text_of(checks_of(of));
  if (of.turned_count > 0)
    text += text_of(runs_of(of, std::min<std::size_t>(of.turned_count, kShownRuns), false));
  return text;
}

std::string as_html(const RecordingComparison& of, const std::string& a, const std::string& b) {
  return page(of.equal, first_words(of), a, b,
              courses_of(of) + html_of(ports_of(of, of.ports.size())) +
                  list_of("Made differently", of.settings) + list_of("Only in A", of.only_a) +
                  list_of("Only in B", of.only_b));
}

std::string as_html(const CampaignComparison& of, const std::string& a, const std::string& b) {
  std::string runs;
  if (!of.different.empty()) {
    runs = "<h2>Runs that end differently</h2>\n";
    if (of.different_count > kListedRuns)
      runs += "<p>The first " + number(std::uint64_t{kListedRuns}) + " of " + number(of.different_count) +
              ", those with another verdict before all others; --json has more.</p>\n";
    runs += html_of(runs_of(of, kListedRuns, true));
  }
  return page(of.equal, first_words(of), a, b,
              "<p>The runs are paired: equal numbers with equal values. <i>p</i> is the probability of such "
              "different counts if A and B are equally good (McNemar's exact test). <i>B - A</i> is the mean "
              "difference of the check's value, <i>from</i> and <i>to</i> its interval of 95 % confidence, "
              "<i>at most</i> the largest difference.</p>\n" +
                  html_of(checks_of(of)) + list_of("Made differently", of.settings) + runs);
}

}  // namespace visum::compare
