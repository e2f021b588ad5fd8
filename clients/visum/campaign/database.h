// SQLite, as results.h needs it: statements that end with their object, and errors as exceptions. One thread.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

struct sqlite3;
struct sqlite3_stmt;

namespace visum::campaign {

class Database;

// A prepared statement. Values are bound from the left, by order; columns count from 0.
class Statement {
 public:
  Statement(Database& database, std::string_view sql);
  ~Statement();
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;

  Statement& reset();  // and forgets what was bound
  Statement& bind(std::int64_t number);
  Statement& bind(std::size_t number) { return bind(static_cast<std::int64_t>(number)); }
  Statement& bind(int number) { return bind(static_cast<std::int64_t>(number)); }
  Statement& bind(bool flag) { return bind(static_cast<std::int64_t>(flag)); }
  Statement& bind(double number);  // NaN becomes NULL
  Statement& bind(const std::optional<double>& number);
  Statement& bind(const std::string& text);

  bool step();  // true: there is a row
  void run();   // to its end, for statements without rows

  std::int64_t integer(int column) const;
  std::size_t size(int column) const { return static_cast<std::size_t>(integer(column)); }
  std::optional<double> real(int column) const;  // nothing for NULL
  std::string text(int column) const;

 private:
  Database& database_;
  sqlite3_stmt* statement_ = nullptr;
  int bound_ = 0;
};

// A file. All errors are cli::ExitError(kInvalid), since they leave no verdict, with the file's name and
// SQLite's reason.
class Database {
 public:
  enum class Use { kRead, kWrite };
  // To write: made where it is missing, and nobody else can write until this object goes. What was committed
  // stays when the process is killed.
  Database(const std::filesystem::path& file, Use use);
  ~Database();
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  void run(const std::string& sql);  // one or several statements without rows
  int changes() const;               // rows that the last statement changed
  void close();                      // as one file, without a journal beside it
  [[noreturn]] void fail() const;    // with SQLite's last reason

 private:
  friend class Statement;
  std::string file_;
  sqlite3* handle_ = nullptr;
  Use use_;
};

}  // namespace visum::campaign
