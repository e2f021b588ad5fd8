// The forms of a search, in those of a campaign's summary.
#include "clients/visum/campaign/summary.h"
#include "clients/visum/common/format.h"
#include "clients/visum/common/markup.h"

namespace visum::campaign {
namespace {

// "-0.13 m"
std::string margin_text(const SearchDone& search) {
  return cli::rounded(*search.margin, 5) + (search.unit.empty() ? "" : " " + search.unit);
}

std::string course(const SearchDone& search) {
  std::string text = std::to_string(search.runs) + " runs in " + std::to_string(search.generations) +
                     " generations from " + std::to_string(search.starts) +
                     (search.starts == 1 ? " start" : " starts");
  if (search.reused > 0) text += ", " + std::to_string(search.reused) + " were there already";
  text += search.broken == 0 ? "; none broke it"
                             : "; " + std::to_string(search.broken) + " broke it, the first was number " +
                                   std::to_string(search.first_broken);
  if (search.invalid > 0) text += "; " + std::to_string(search.invalid) + " are invalid";
  return text;
}

std::string find(const SearchDone& search) {
  if (search.worst_run == 0) return "no run says anything about it";
  return (search.margin ? "least margin " + margin_text(search)
                        : std::string("failed before it could be measured")) +
         " in run " + std::to_string(search.worst_run) + " (" + search.values + ")";
}

}  // namespace

void write_search(cli::JsonWriter& json, const SearchDone& search) {
  json.key("search").begin_object().member("check", search.check).member("unit", search.unit);
  json.member("runs", search.runs).member("generations", search.generations).member("starts", search.starts);
  json.member("broken", search.broken).member("invalid", search.invalid).member("reused", search.reused);
  json.key("first_broken");
  search.first_broken != 0 ? json.value(search.first_broken) : json.null();
  json.key("margin");
  search.margin ? json.value(*search.margin) : json.null();
  json.member("worst_run", search.worst_run).member("values", search.values);
  json.member("scenario", search.scenario).member("recording", search.recording);
  json.member("trouble", search.trouble).member("hash", cli::hex(search.hash)).end_object();
}

std::string search_text(const SearchDone& search) {
  std::string text =
      "search for what breaks '" + search.check + "': " + course(search) + "\n  " + find(search) + "\n";
  if (!search.scenario.empty())
    text += "  as a scenario: " + search.scenario +
            (search.recording.empty() ? "" : "; its recording: " + search.recording) + "\n";
  if (!search.trouble.empty()) text += "  " + search.trouble + "\n";
  return text;
}

std::string search_html(const SearchDone& search) {
  using cli::markup;
  std::string page = "<h2>Search</h2>\n<p>For what breaks <b>" + markup(search.check) +
                     "</b>: " + markup(course(search)) + ".</p>\n<p class=\"" +
                     (search.broken > 0 || (search.margin && *search.margin < 0.0) ? "bad" : "good") + "\">" +
                     markup(find(search)) + "</p>\n";
  if (!search.scenario.empty())
    page += "<p>Again: <code>visum run " + markup(search.scenario) + "</code>" +
            (search.recording.empty() ? "" : "; <code>visum replay " + markup(search.recording) + "</code>") +
            "</p>\n";
  if (!search.trouble.empty()) page += "<p class=\"bad\">" + markup(search.trouble) + "</p>\n";
  return page + "<p>Hash of its runs <code>" + cli::hex(search.hash) + "</code></p>\n";
}

}  // namespace visum::campaign
