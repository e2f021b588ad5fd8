// The results of a campaign or a shard: FOLDER/results.sqlite, one row for each run and each check.
// CAMPAIGNS.md describes the tables. A run is written as a whole and at once, so a process that is killed
// loses no run that was finished. One thread.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "clients/visum/campaign/database.h"
#include "clients/visum/campaign/shard.h"
#include "clients/visum/campaign/statistics.h"
#include "clients/visum/run/decide.h"
#include "clients/visum/run/report.h"

namespace visum::campaign {

// A campaign's own: results of two that differ here do not belong together.
struct Identity {
  std::string name;                     // the scenario's
  std::string file;                     // as given; for people
  std::string sweep;                    // XXH64 of the scenario's text and of the options that override it
  std::string build;                    // Visum's version, and XXH64 of its programs
  std::size_t runs = 1;                 // of all shards
  std::optional<run::Decide> decide{};  // as the scenario says; part of `sweep`

  bool operator==(const Identity& other) const {
    return sweep == other.sweep && build == other.build && runs == other.runs;
  }
  // Says what differs: "another build (0.2.0 1f..., not 0.2.0 9a...)".
  std::string difference(const Identity& other) const;
};

// One run, as the tables keep it.
struct Row {
  std::size_t run = 0;
  std::string parameters;  // the sweep's values as JSON, {"mass":"0.2"}
  int code = 0;
  std::string error;  // or what failed
  std::uint64_t state_hash = 0;
  std::int64_t ticks = 0;
  double sim_seconds = 0.0;
  std::string key;         // of its content (content_key.h)
  bool reusable = false;   // a valid run in lockstep
  std::string recording;   // its file, relative to the folder; empty: none
  std::int64_t files = 0;  // which files it used; 0: not known

  SequentialTest::Outcome outcome() const;
};

std::string word_of(SequentialTest::Outcome outcome);  // "passed"
// The sweep's names and values of a run.
std::vector<std::pair<std::string, std::string>> values_of(const Row& row);
std::string values_text(const Row& row);  // "mass=0.2, seed=1"

class Results {
 public:
  static constexpr const char* kFile = "results.sqlite";

  // Opens the results of FOLDER to write, or begins them. Where they are of another campaign, all that is
  // there is kept aside for find_earlier(). Throws cli::ExitError, also where somebody else writes to them.
  Results(const std::filesystem::path& folder, const Identity& identity, const Shard& shard);
  // Opens results that are there. Throws cli::ExitError(kUsage) where there are none.
  explicit Results(const std::filesystem::path& folder);

  const Identity& identity() const { return identity_; }
  const Shard& shard() const { return shard_; }

  // Writes a run, in place of an older one of its number. `host`: where it ran.
  void add(const Row& row, const run::Report& report, const std::string& host);
  std::optional<Row> find(std::size_t run);
  // A run of an earlier campaign in this folder with that content.
  std::optional<Row> find_earlier(const std::string& key);
  // Gives the earlier run the number that it has in this campaign.
  void adopt(const Row& earlier, std::size_t run, const std::string& parameters);
  std::vector<std::pair<std::string, std::string>> files(std::int64_t set);
  // Takes over run after run of `other`, from number `first` to `last`. `folder`: what leads to its
  // recordings. Returns the numbers that both have, at most `kMostListed`.
  std::vector<std::size_t> take_over(Results& other, const std::filesystem::path& folder, std::size_t first,
                                     std::size_t last);
  // Calls in the order of runs, from number `first` (1) to `last`.
  void for_each(std::size_t first, std::size_t last, const std::function<void(const Row&)>& call);
  void for_each(std::size_t last, const std::function<void(const Row&)>& call) { for_each(1, last, call); }
  // Runs of equal content in lockstep with different state hashes: the numbers of such, at most kMostListed.
  std::vector<std::size_t> nondeterministic(std::size_t last);
  Database& database() { return database_; }
  // Forgets what find_earlier() could find.
  void forget_earlier();
  void close();

  static constexpr std::size_t kMostListed = 1000;

 private:
  void make_tables();
  void read_head();
  void write_head();
  std::int64_t note_files(const std::vector<std::pair<std::string, std::string>>& files);

  Database database_;
  Identity identity_;
  Shard shard_;
  std::optional<Statement> add_run_, add_check_, add_time_, find_run_, find_key_;
  std::vector<std::pair<std::string, std::string>> last_files_;
  std::int64_t last_set_ = 0;
};

}  // namespace visum::campaign
