#include "clients/visum/campaign/database.h"

#include <sqlite3.h>

#include <cmath>

#include "clients/visum/common/exit_code.h"

namespace visum::campaign {

Statement::Statement(Database& database, std::string_view sql) : database_(database) {
  if (sqlite3_prepare_v2(database.handle_, sql.data(), static_cast<int>(sql.size()), &statement_, nullptr) !=
      SQLITE_OK)
    database.fail();
}

Statement::~Statement() {
  sqlite3_finalize(statement_);
}

Statement& Statement::reset() {
  sqlite3_reset(statement_);
  sqlite3_clear_bindings(statement_);
  bound_ = 0;
  return *this;
}

Statement& Statement::bind(std::int64_t number) {
  if (sqlite3_bind_int64(statement_, ++bound_, number) != SQLITE_OK) database_.fail();
  return *this;
}

Statement& Statement::bind(double number) {
  if (sqlite3_bind_double(statement_, ++bound_, number) != SQLITE_OK) database_.fail();
  return *this;
}

Statement& Statement::bind(const std::optional<double>& number) {
  if (number) return bind(*number);
  ++bound_;  // NULL is what stands there
  return *this;
}

Statement& Statement::bind(const std::string& text) {
  if (sqlite3_bind_text(statement_, ++bound_, text.data(), static_cast<int>(text.size()), SQLITE_TRANSIENT) !=
      SQLITE_OK)
    database_.fail();
  return *this;
}

bool Statement::step() {
  const int result = sqlite3_step(statement_);
  if (result == SQLITE_ROW) return true;
  if (result != SQLITE_DONE) database_.fail();
  return false;
}

void Statement::run() {
  while (step()) {
  }
  reset();
}

std::int64_t Statement::integer(int column) const {
  return sqlite3_column_int64(statement_, column);
}

std::optional<double> Statement::real(int column) const {
  if (sqlite3_column_type(statement_, column) == SQLITE_NULL) return std::nullopt;
  return sqlite3_column_double(statement_, column);
}

std::string Statement::text(int column) const {
  const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(statement_, column));
  return text ? std::string(text, static_cast<std::size_t>(sqlite3_column_bytes(statement_, column))) : "";
}

Database::Database(const std::filesystem::path& file, Use use) : file_(file.string()), use_(use) {
  const bool writes = use == Use::kWrite;
  // A reader opens it to write, too: SQLite then completes what a process that was killed has left.
  const int flags = SQLITE_OPEN_READWRITE | (writes ? SQLITE_OPEN_CREATE : 0);
  int result = sqlite3_open_v2(file_.c_str(), &handle_, flags, nullptr);
  if (result == SQLITE_OK) result = sqlite3_busy_timeout(handle_, 0);
  try {
    if (result != SQLITE_OK) fail();
    if (!writes) return;
    run("PRAGMA locking_mode=EXCLUSIVE; PRAGMA journal_mode=WAL; PRAGMA synchronous=NORMAL; BEGIN EXCLUSIVE; "
        "COMMIT");
  } catch (...) {
    sqlite3_close_v2(handle_);
    throw;
  }
}

Database::~Database() {
  sqlite3_close_v2(handle_);
}

void Database::run(const std::string& sql) {
  if (sqlite3_exec(handle_, sql.c_str(), nullptr, nullptr, nullptr) != SQLITE_OK) fail();
}

int Database::changes() const {
  return sqlite3_changes(handle_);
}

void Database::close() {
  if (use_ == Use::kWrite) run("PRAGMA wal_checkpoint(TRUNCATE); PRAGMA journal_mode=DELETE");
  if (sqlite3_close(handle_) != SQLITE_OK) fail();
  handle_ = nullptr;
}

void Database::fail() const {
  const int code = sqlite3_errcode(handle_);
  std::string reason = sqlite3_errmsg(handle_);
  if (code == SQLITE_BUSY || code == SQLITE_LOCKED) reason = "another run writes to it now";
  if (code == SQLITE_FULL) reason = "the disk is full; what was written before is kept";
  if (code == SQLITE_NOTADB || code == SQLITE_CORRUPT) reason += "; it holds no results that can be read";
  throw cli::ExitError(cli::kInvalid, file_ + ": " + reason);
}

}  // namespace visum::campaign
