#include "clients/visum/campaign/results.h"

#include <sys/stat.h>

#include <charconv>
#include <system_error>

#include "clients/visum/common/exit_code.h"
#include "clients/visum/common/format.h"
#include "protocol/config/config.h"

namespace visum::campaign {
namespace {

constexpr int kVersion = 1;

// Numbers below 0 are runs of earlier campaigns in this folder. What stands in `times` may differ between two
// executions of one campaign; all else may not.
constexpr const char* kTables = R"(
CREATE TABLE IF NOT EXISTS head(version INTEGER, name TEXT, file TEXT, sweep TEXT, build TEXT, runs INTEGER,
  shard INTEGER, shards INTEGER, at_least REAL, reject_below REAL, false_reject REAL, false_accept REAL);
CREATE TABLE IF NOT EXISTS runs(run INTEGER PRIMARY KEY, parameters TEXT, code INTEGER, error TEXT,
  state_hash TEXT, ticks INTEGER, sim_seconds REAL, key TEXT, reusable INTEGER, recording TEXT, files INTEGER);
CREATE INDEX IF NOT EXISTS runs_by_key ON runs(key);
CREATE TABLE IF NOT EXISTS checks(run INTEGER, number INTEGER, name TEXT, passed INTEGER, value REAL, unit TEXT,
  bound TEXT, at_s REAL, margin REAL, PRIMARY KEY(run, number)) WITHOUT ROWID;
CREATE TABLE IF NOT EXISTS times(run INTEGER PRIMARY KEY, wall_seconds REAL, host TEXT);
CREATE TABLE IF NOT EXISTS files(part INTEGER, path TEXT, hash TEXT, PRIMARY KEY(part, path)) WITHOUT ROWID;
)";

constexpr const char* kColumns =
    "run, parameters, code, error, state_hash, ticks, sim_seconds, key, reusable, recording, files";

Row row_of(const Statement& found) {
  Row row;
  row.run = found.size(0);
  row.parameters = found.text(1);
  row.code = static_cast<int>(found.integer(2));
  row.error = found.text(3);
  const std::string hash = found.text(4);
  std::from_chars(hash.data(), hash.data() + hash.size(), row.state_hash, 16);
  row.ticks = found.integer(5);
  row.sim_seconds = found.real(6).value_or(0.0);
  row.key = found.text(7);
  row.reusable = found.integer(8) != 0;
  row.recording = found.text(9);
  row.files = found.integer(10);
  return row;
}

std::filesystem::path made(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw cli::ExitError(cli::kUsage, folder.string() + ": " + error.message());
  return folder / Results::kFile;
}

std::filesystem::path found(const std::filesystem::path& folder) {
  const auto file = folder / Results::kFile;
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error))
    throw cli::ExitError(cli::kUsage, folder.string() + ": holds no " + Results::kFile);
  return file;
}

}  // namespace

std::string Identity::difference(const Identity& other) const {
  if (sweep != other.sweep) return "another sweep ('" + other.file + "' with other text or options)";
  if (build != other.build) return "another build (" + other.build + ", not " + build + ")";
  if (runs != other.runs) return std::to_string(other.runs) + " runs in all, not " + std::to_string(runs);
  return {};
}

SequentialTest::Outcome Row::outcome() const {
  if (code == cli::kDone) return SequentialTest::Outcome::kPassed;
  return code == cli::kFailed || code == cli::kLost ? SequentialTest::Outcome::kFailed
                                                    : SequentialTest::Outcome::kInvalid;
}

std::string word_of(SequentialTest::Outcome outcome) {
  if (outcome == SequentialTest::Outcome::kPassed) return "passed";
  return outcome == SequentialTest::Outcome::kFailed ? "failed" : "invalid";
}

std::vector<std::pair<std::string, std::string>> values_of(const Row& row) {
  std::vector<std::pair<std::string, std::string>> values;
  const auto node = config::load_text(row.parameters, "the parameters of run " + std::to_string(row.run));
  for (const auto& name : node.keys()) values.emplace_back(name, node.get(name).text());
  return values;
}

std::string values_text(const Row& row) {
  std::string text;
  for (const auto& [name, value] : values_of(row)) text += (text.empty() ? "" : ", ") + name + "=" + value;
  return text;
}

Results::Results(const std::filesystem::path& folder, const Identity& identity, const Shard& shard)
    : database_(made(folder), Database::Use::kWrite) {
  make_tables();
  read_head();
  if (identity_.sweep.empty() || !(identity_ == identity) || !(shard_ == shard)) {
    // Numbers grow downwards, below all that are there.
    Statement least(database_, "SELECT MIN(0, COALESCE(MIN(run), 0)) FROM runs");
    least.step();
    const std::string below = std::to_string(least.integer(0));
    least.reset();
    database_.run("BEGIN");
    for (const char* table : {"runs", "checks", "times"})
      database_.run("UPDATE " + std::string(table) + " SET run = " + below + " - run WHERE run > 0");
    database_.run("COMMIT");
  }
  identity_ = identity;
  shard_ = shard;
  write_head();
}

Results::Results(const std::filesystem::path& folder) : database_(found(folder), Database::Use::kRead) {
  read_head();
  if (identity_.sweep.empty())
    throw cli::ExitError(cli::kUsage, folder.string() + ": its results never began");
}

void Results::make_tables() {
  database_.run(kTables);
  add_run_.emplace(database_, "INSERT OR REPLACE INTO runs VALUES(?,?,?,?,?,?,?,?,?,?,?)");
  add_check_.emplace(database_, "INSERT INTO checks VALUES(?,?,?,?,?,?,?,?,?)");
  add_time_.emplace(database_, "INSERT OR REPLACE INTO times VALUES(?,?,?)");
}

void Results::read_head() {
  Statement head(database_,
                 "SELECT version, name, file, sweep, build, runs, shard, shards, at_least, reject_below, "
                 "false_reject, false_accept FROM head");
  if (!head.step()) return;
  if (head.integer(0) != kVersion)
    throw cli::ExitError(cli::kUsage, "results of version " + head.text(0) + "; this program knows version " +
                                          std::to_string(kVersion));
  identity_ = {head.text(1), head.text(2), head.text(3), head.text(4), head.size(5)};
  shard_ = {head.size(6), head.size(7)};
  if (const auto at_least = head.real(8))
    identity_.decide = run::Decide{*at_least, *head.real(9), *head.real(10), *head.real(11)};
}

void Results::write_head() {
  database_.run("BEGIN; DELETE FROM head");
  const auto share = [this](double run::Decide::*field) {
    return identity_.decide ? std::optional((*identity_.decide).*field) : std::nullopt;
  };
  Statement(database_, "INSERT INTO head VALUES(?,?,?,?,?,?,?,?,?,?,?,?)")
      .bind(kVersion)
      .bind(identity_.name)
      .bind(identity_.file)
      .bind(identity_.sweep)
      .bind(identity_.build)
      .bind(identity_.runs)
      .bind(shard_.index)
      .bind(shard_.count)
      .bind(share(&run::Decide::at_least))
      .bind(share(&run::Decide::reject_below))
      .bind(share(&run::Decide::false_reject))
      .bind(share(&run::Decide::false_accept))
      .run();
  database_.run("COMMIT");
}

// Most runs of a campaign use the same files.
std::int64_t Results::note_files(const std::vector<std::pair<std::string, std::string>>& files) {
  if (files.empty()) return 0;
  if (last_set_ != 0 && files == last_files_) return last_set_;
  Statement most(database_, "SELECT COALESCE(MAX(part), 0) FROM files");
  most.step();
  last_set_ = most.integer(0) + 1;
  last_files_ = files;
  Statement add(database_, "INSERT OR REPLACE INTO files VALUES(?,?,?)");
  for (const auto& [path, hash] : files) add.bind(last_set_).bind(path).bind(hash).run();
  return last_set_;
}

void Results::add(const Row& row, const run::Report& report, const std::string& host) {
  database_.run("BEGIN");
  try {
    const std::int64_t set = note_files(report.files);
    Statement(database_, "DELETE FROM checks WHERE run = ?").bind(row.run).run();
    add_run_->bind(row.run)
        .bind(row.parameters)
        .bind(row.code)
        .bind(row.error)
        .bind(cli::hex(row.state_hash));
    add_run_->bind(row.ticks).bind(row.sim_seconds).bind(row.key).bind(row.reusable).bind(row.recording);
    add_run_->bind(set).run();
    std::size_t number = 0;
    for (const auto& check : report.checks) {
      add_check_->bind(row.run).bind(++number).bind(check.name).bind(check.passed).bind(check.value);
      add_check_->bind(check.unit).bind(check.bound).bind(check.at_s).bind(check.margin).run();
    }
    add_time_->bind(row.run).bind(report.wall_seconds).bind(host).run();
    database_.run("COMMIT");
  } catch (...) {
    last_set_ = 0;
    try {
      database_.run("ROLLBACK");
    } catch (const cli::ExitError&) {  // it has rolled back by itself
    }
    throw;
  }
}

std::optional<Row> Results::find(std::size_t run) {
  if (!find_run_)
    find_run_.emplace(database_, std::string("SELECT ") + kColumns + " FROM runs WHERE run = ?");
  if (!find_run_->reset().bind(run).step()) return std::nullopt;
  Row row = row_of(*find_run_);
  find_run_->reset();
  return row;
}

std::optional<Row> Results::find_earlier(const std::string& key) {
  if (!find_key_)
    find_key_.emplace(database_, std::string("SELECT ") + kColumns +
                                     " FROM runs WHERE key = ? AND run < 0 AND reusable = 1 LIMIT 1");
  if (!find_key_->reset().bind(key).step()) return std::nullopt;
  Row row = row_of(*find_key_);
  find_key_->reset();
  return row;
}

void Results::adopt(const Row& earlier, std::size_t run, const std::string& parameters) {
  const auto from = static_cast<std::int64_t>(earlier.run);
  database_.run("BEGIN");
  for (const char* table : {"runs", "checks", "times"}) {
    Statement(database_, "DELETE FROM " + std::string(table) + " WHERE run = ?").bind(run).run();
    Statement(database_, "UPDATE " + std::string(table) + " SET run = ? WHERE run = ?")
        .bind(run)
        .bind(from)
        .run();
  }
  Statement(database_, "UPDATE runs SET parameters = ? WHERE run = ?").bind(parameters).bind(run).run();
  database_.run("COMMIT");
}

std::vector<std::pair<std::string, std::string>> Results::files(std::int64_t set) {
  std::vector<std::pair<std::string, std::string>> files;
  Statement found(database_, "SELECT path, hash FROM files WHERE part = ? ORDER BY path");
  found.bind(set);
  while (found.step()) files.emplace_back(found.text(0), found.text(1));
  return files;
}

std::vector<std::size_t> Results::take_over(Results& other, const std::filesystem::path& folder,
                                            std::size_t first, std::size_t last) {
  std::vector<std::size_t> doubled;
  database_.run("BEGIN");
  Statement offset(database_, "SELECT COALESCE(MAX(part), 0) FROM files");
  offset.step();
  const std::int64_t sets = offset.integer(0);
  offset.reset();
  Statement has(database_, "SELECT 1 FROM runs WHERE run = ?");
  other.for_each(first, last, [&](const Row& row) {
    if (has.reset().bind(row.run).step()) {
      if (doubled.size() < kMostListed) doubled.push_back(row.run);
      return;
    }
    const std::string recording =
        row.recording.empty() ? "" : (folder / row.recording).lexically_normal().string();
    add_run_->bind(row.run)
        .bind(row.parameters)
        .bind(row.code)
        .bind(row.error)
        .bind(cli::hex(row.state_hash));
    add_run_->bind(row.ticks).bind(row.sim_seconds).bind(row.key).bind(row.reusable).bind(recording);
    add_run_->bind(row.files == 0 ? 0 : sets + row.files).run();
  });
  has.reset();
  Statement checks(other.database_,
                   "SELECT run, number, name, passed, value, unit, bound, at_s, margin FROM checks WHERE run "
                   "BETWEEN ? AND ?");
  checks.bind(first).bind(last);
  Statement add(database_, "INSERT OR IGNORE INTO checks VALUES(?,?,?,?,?,?,?,?,?)");
  while (checks.step()) {
    add.bind(checks.integer(0)).bind(checks.integer(1)).bind(checks.text(2)).bind(checks.integer(3));
    add.bind(checks.real(4))
        .bind(checks.text(5))
        .bind(checks.text(6))
        .bind(checks.real(7))
        .bind(checks.real(8));
    add.run();
  }
  Statement times(other.database_, "SELECT run, wall_seconds, host FROM times WHERE run BETWEEN ? AND ?");
  times.bind(first).bind(last);
  while (times.step()) add_time_->bind(times.integer(0)).bind(times.real(1)).bind(times.text(2)).run();
  Statement files(other.database_, "SELECT part, path, hash FROM files");
  Statement add_file(database_, "INSERT INTO files VALUES(?,?,?)");
  while (files.step()) add_file.bind(sets + files.integer(0)).bind(files.text(1)).bind(files.text(2)).run();
  database_.run("COMMIT");
  return doubled;
}

void Results::for_each(std::size_t first, std::size_t last, const std::function<void(const Row&)>& call) {
  Statement all(database_,
                std::string("SELECT ") + kColumns + " FROM runs WHERE run >= ? AND run <= ? ORDER BY run");
  all.bind(first).bind(last);
  while (all.step()) call(row_of(all));
}

std::vector<std::size_t> Results::nondeterministic(std::size_t last) {
  std::vector<std::size_t> runs;
  Statement found(
      database_,
      "SELECT run FROM runs WHERE run > 0 AND run <= ?1 AND reusable = 1 AND key IN (SELECT key FROM runs "
      "WHERE run > 0 AND run <= ?1 AND reusable = 1 GROUP BY key HAVING COUNT(DISTINCT state_hash) > 1) "
      "ORDER BY run LIMIT " +
          std::to_string(kMostListed));
  found.bind(last);
  while (found.step()) runs.push_back(found.size(0));
  return runs;
}

void Results::forget_earlier() {
  for (const char* table : {"runs", "checks", "times"})
    database_.run("DELETE FROM " + std::string(table) + " WHERE run < 0");
}

void Results::close() {
  for (auto* statement : {&add_run_, &add_check_, &add_time_, &find_run_, &find_key_}) statement->reset();
  database_.close();
}

}  // namespace visum::campaign
