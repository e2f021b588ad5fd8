// Numbers, times and tables as text, the same in every verb and in every locale.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace visum::cli {

std::string exact(double number);                // the shortest text that reads back to the same bits
std::string rounded(double number, int digits);  // `digits` significant ones, "0.0123", "-1.2e+10"
std::string fixed(double number, int decimals);  // "-0.333"; never "-0.000"
// For people: whole numbers in full, others with `digits` significant ones. Values below 1e-300, which only
// rounding errors produce, become "0".
std::string readable(double number, int digits = 6);
std::string seconds(std::int64_t time_ns);  // "1.250 s"
std::string hex(std::uint64_t hash);        // 16 digits

// A table as text: a line for each row, columns padded to their widest cell, two blanks between them. Cells
// that could steer the terminal are escaped.
class Table {
 public:
  void row(std::vector<std::string> cells);
  std::string text(const std::string& indent = {}) const;

 private:
  std::vector<std::vector<std::string>> rows_;
};

}  // namespace visum::cli
