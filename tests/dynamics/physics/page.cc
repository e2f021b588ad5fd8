#include "tests/dynamics/physics/page.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>
#include <stdexcept>

#include "tests/dynamics/physics/expectations.h"

namespace visum::physics {
namespace {

const std::string kEnd = "<!-- physics_table: end -->\n";

struct Range {
  std::size_t begin, end;
};

Range find_block(const std::string& page, const std::string& name) {
  const std::string start = "<!-- physics_table: " + name + " -->\n";
  const std::size_t found = page.find(start);
  const std::size_t begin = found + start.size();
  const std::size_t end = found == std::string::npos ? found : page.find(kEnd, begin);
  if (end == std::string::npos) throw std::runtime_error("the page has no block '" + name + "'");
  return {begin, end};
}

std::string number(double value) {
  if (std::isinf(value)) return "∞";
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.2g", value);
  return text.data();
}

// The demands: one, or one for each order if they differ.
std::string demanded(const std::array<double, 3>& demands) {
  const bool one = demands[1] == demands[0] && demands[2] == demands[0];
  std::array<char, 96> text{};
  std::snprintf(text.data(), text.size(), one ? "%.3g" : "%.3g, %.3g, %.3g by order", demands[0], demands[1],
                demands[2]);
  return text.data();
}

// Escapes bars, which would end the cell.
std::string in_cell(std::string text) {
  for (std::size_t at = 0; (at = text.find('|', at)) != std::string::npos; at += 2) text.insert(at, "\\");
  return text;
}

std::string joined(const std::vector<std::string>& parts) {
  std::string all;
  for (const std::string& part : parts) all += (all.empty() ? "" : ", ") + part;
  return all;
}

std::size_t columns(const std::string& text) {
  const auto begins_a_character = [](char byte) { return (static_cast<unsigned char>(byte) & 0xc0) != 0x80; };
  return static_cast<std::size_t>(std::ranges::count_if(text, begins_a_character));
}

// An item of a list, wrapped at 100 columns as prose is.
std::string item(const std::string& text) {
  constexpr std::size_t kMostColumns = 100;
  std::istringstream words(text);
  std::string all, line = "-";
  for (std::string word; words >> word;) {
    if (columns(line) + 1 + columns(word) > kMostColumns) {
      all += line + "\n";
      line = " ";
    }
    line += " " + word;
  }
  return all + line + "\n";
}

std::vector<std::string> ids_with(const std::string& row, Mark mark) {
  std::vector<std::string> ids;
  for (const Case& what : cases())
    if (expected_mark(what, row) == mark) ids.emplace_back(what.id);
  return ids;
}

std::string cell(const Case& what, const std::string& row, const std::vector<double>& figures) {
  const Mark mark = expected_mark(what, row);
  if (mark == Mark::kNotRun) return text_of(mark);
  const bool breaks = std::ranges::any_of(figures, [](double figure) { return std::isinf(figure); });
  return text_of(mark) + " " + (breaks ? "breaks" : number(worst_share(what, row, figures)));
}

}  // namespace

std::string read_page(const std::string& path) {
  std::ifstream file(std::filesystem::path(VISUM_SOURCE_DIR) / path);
  std::ostringstream text;
  text << file.rdbuf();
  if (!file) throw std::runtime_error("cannot read " + path);
  return text.str();
}

void write_page(const std::string& path, const std::string& text) {
  std::ofstream file(std::filesystem::path(VISUM_SOURCE_DIR) / path);
  file << text << std::flush;
  if (!file) throw std::runtime_error("cannot write " + path);
}

std::string block(const std::string& page, const std::string& name) {
  const auto [begin, end] = find_block(page, name);
  return page.substr(begin, end - begin);
}

std::string with_block(const std::string& page, const std::string& name, const std::string& text) {
  const auto [begin, end] = find_block(page, name);
  return page.substr(0, begin) + text + page.substr(end);
}

Mark expected_mark(const Case& what, const std::string& row) {
  const Expectation* expectation = find_expectation(what.id, row);
  if (!expectation || expectation->bounds.empty()) return Mark::kNotRun;
  const std::size_t count = std::min(expectation->bounds.size(), what.figures.size());
  for (std::size_t i = 0; i < count; ++i)
    if (!(expectation->bounds[i] <= what.figures[i].demand(row))) return Mark::kMissed;
  return Mark::kReached;
}

std::string text_of(Mark mark) {
  if (mark == Mark::kNotRun) return "—";
  return mark == Mark::kReached ? "✓" : "✗";
}

std::vector<std::string> expected_rows() {
  std::vector<std::string> rows;
  for (const Expectation& one : expectations())
    if (std::ranges::find(rows, one.row) == rows.end()) rows.push_back(one.row);
  return rows;
}

std::string misses_text() {
  std::string text;
  for (const std::string& row : expected_rows()) {
    const auto missed = ids_with(row, Mark::kMissed);
    const std::size_t run = missed.size() + ids_with(row, Mark::kReached).size();
    text += item("`" + row + "` misses " + std::to_string(missed.size()) + " of " + std::to_string(run) +
                 (missed.empty() ? "" : ": " + joined(missed)));
  }
  return text;
}

std::string not_run_text() {
  struct Said {
    std::string reason, ids, rows;
  };
  std::vector<Said> all;  // rows with the same reason for the same cases share an item
  for (const std::string& row : expected_rows()) {
    std::vector<std::pair<std::string, std::vector<std::string>>> reasons;
    for (const std::string& id : ids_with(row, Mark::kNotRun)) {
      const Expectation* expectation = find_expectation(id, row);
      const std::string reason = expectation ? expectation->reason : "nothing is expected";
      auto found = std::ranges::find(reasons, reason, &decltype(reasons)::value_type::first);
      if (found == reasons.end()) found = reasons.insert(found, {reason, {}});
      found->second.push_back(id);
    }
    for (const auto& [reason, ids] : reasons) {
      const Said said{reason, joined(ids), "`" + row + "`"};
      const auto same = [&](const Said& one) { return one.reason == said.reason && one.ids == said.ids; };
      const auto found = std::ranges::find_if(all, same);
      if (found == all.end())
        all.push_back(said);
      else
        found->rows += ", `" + row + "`";
    }
  }
  std::string text;
  for (const Said& one : all) text += item(one.rows + ": " + one.reason + " (" + one.ids + ")");
  return text;
}

std::string table_head() {
  std::string names = "| case | source | right is at most |", rule = "| --- | --- | --- |";
  for (const std::string& row : expected_rows()) {
    names += " " + row + " |";
    rule += " --- |";
  }
  return names + "\n" + rule + "\n";
}

std::string line_start(const Case& what) {
  std::vector<std::string> demands;
  for (const Figure& figure : what.figures)
    demands.push_back("`" + std::string(figure.name) + "` " + demanded(figure.demands));
  return std::string("| ") + what.id + " " + what.claim + (what.takes_long ? " (long)" : "") + " | " +
         in_cell(what.source) + " | " + joined(demands) + " |";
}

std::string table_line(const Case& what, const Figures& figures) {
  std::string line = line_start(what);
  for (const std::string& row : expected_rows()) {
    const auto found = figures.find(row);
    line += " " + cell(what, row, found == figures.end() ? std::vector<double>() : found->second) + " |";
  }
  return line + "\n";
}

double worst_share(const Case& what, const std::string& row, const std::vector<double>& figures) {
  double worst = 0.0;
  for (std::size_t i = 0; i < figures.size() && i < what.figures.size(); ++i) {
    const double demand = what.figures[i].demand(row);
    const double none = figures[i] > 0.0 ? std::numeric_limits<double>::infinity() : 0.0;
    worst = std::max(worst, demand > 0.0 ? figures[i] / demand : none);
  }
  return worst;
}

std::map<std::string, std::string> table_lines(const std::string& table) {
  std::map<std::string, std::string> lines;
  std::istringstream in(table);
  for (std::string line; std::getline(in, line);) {
    if (!line.starts_with("| ") || line.starts_with("| case ") || line.starts_with("| ---")) continue;
    lines[line.substr(2, line.find(' ', 2) - 2)] = line + "\n";
  }
  return lines;
}

std::vector<std::string> marks_of(const std::string& line) {
  std::vector<std::string> cells;
  std::string cell;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] != '|' || (i > 0 && line[i - 1] == '\\')) {
      cell += line[i];
      continue;
    }
    cells.push_back(cell);
    cell.clear();
  }
  constexpr std::size_t kBefore = 4;  // the text before the first bar, and the cells of line_start()
  std::vector<std::string> marks;
  for (std::size_t i = kBefore; i < cells.size(); ++i)
    marks.push_back(cells[i].substr(1, cells[i].find(' ', 1) - 1));
  return marks;
}

}  // namespace visum::physics
