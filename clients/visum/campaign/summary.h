// Figures and statistics of a campaign's results, and the forms in which they are shown. The same
// results give the same summary, wherever they were made.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "clients/visum/campaign/influence.h"
#include "clients/visum/campaign/results.h"
#include "clients/visum/campaign/search.h"
#include "clients/visum/campaign/statistics.h"
#include "clients/visum/common/exit_code.h"
#include "clients/visum/common/json_writer.h"
#include "clients/visum/run/decide.h"

namespace visum::campaign {

// A check over all runs.
struct CheckFigures {
  std::string name, unit, bound;
  std::size_t runs = 0, passed = 0;
  std::optional<double> least, low, median, high, most;  // values: the ends, 5 %, 50 % and 95 %
  std::optional<double> margin;       // the least: nearest to failing, or furthest from passing
  std::size_t worst_run = 0;          // which has that
  std::vector<Influence> influences;  // of the parameters on the margin
};

struct Summary {
  std::size_t runs = 0;  // that count: up to the decision, if there is one
  std::size_t all = 0;   // of the campaign
  std::size_t passed = 0, failed = 0, invalid = 0, reused = 0;
  double pass_rate = 0.0;  // of the valid runs
  Interval interval;
  std::optional<run::Decide> decide;
  Decision decision = Decision::kUndecided;
  std::size_t decided_at = 0;        // run; 0: not decided
  std::uint64_t hash = 0;            // XXH64 over number, parameters, code and state hash of each run
  std::vector<std::size_t> missing;  // runs before the last that count; at most Results::kMostListed
  std::vector<std::size_t>
      nondeterministic;              // equal content, but different state hashes: they count as invalid
  std::vector<std::string> changed;  // files that were not the same for all runs
  std::vector<CheckFigures> checks;
  std::vector<Row> failures;         // the first kShownFailures that failed or are invalid
  std::optional<SearchDone> search;  // of what breaks a check; it does not count in the figures above

  static constexpr std::size_t kShownFailures = 200;
  bool complete() const { return missing.empty(); }
  // 0 accepted, 1 rejected, 6 undecided. Without `decide`: 1 if a run failed, also one of the search, else 6
  // if one is invalid or missing.
  cli::ExitCode code() const;
};

// The verdict is that of a whole campaign: a shard of several has none.
Summary summarize(Results& results);

// {"runs","passed","failed","invalid","reused","pass_rate","low","high","decision","hash", ...}
std::string summary_json(const Summary& summary);
std::string summary_text(const Summary& summary);
// `figures`: HTML, pictures of the sweep.
std::string summary_html(const Summary& summary, const Identity& identity, const std::string& of,
                         const std::string& figures);
// "search": {...}, for summary_json().
void write_search(cli::JsonWriter& json, const SearchDone& search);
std::string search_text(const SearchDone& search);
std::string search_html(const SearchDone& search);
// One line for each run and check, with a column for each name of the sweep.
void write_csv(Results& results, std::size_t last, const std::filesystem::path& file);
// summary.json, report.html and results.csv. Throws cli::ExitError where they cannot be written.
void write_reports(Results& results, const Summary& summary, const std::filesystem::path& folder);

}  // namespace visum::campaign
