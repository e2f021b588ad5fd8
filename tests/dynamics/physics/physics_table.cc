// physics_table: runs the suite's cases and prints their figures as a table in Markdown, beside the demands:
// ✓ right, ✗ wrong, and "!" where expectations.cc expects otherwise. With --write it updates the suite's page
// instead (page.h); cases that it does not run keep their lines.
// usage: physics_table [--long] [--case ID] [--row ROW] [--write]
#include <algorithm>
#include <cstdio>
#include <cstring>
#include <stdexcept>

#include "tests/dynamics/physics/case.h"
#include "tests/dynamics/physics/engine_rows.h"
#include "tests/dynamics/physics/expectations.h"
#include "tests/dynamics/physics/page.h"

namespace {

using namespace visum::physics;

constexpr const char* kUsage = "usage: physics_table [--long] [--case ID] [--row ROW] [--write]";

struct Options {
  bool takes_long = false, writes = false;
  std::string id, row;  // empty: all
};

Options parse(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string option = argv[i];
    if (option == "--long" || option == "--write") {
      (option == "--long" ? options.takes_long : options.writes) = true;
    } else if ((option == "--case" || option == "--row") && i + 1 < argc) {
      (option == "--case" ? options.id : options.row) = argv[++i];
    } else {
      throw std::invalid_argument(kUsage);
    }
  }
  if (options.writes && !options.row.empty())
    throw std::invalid_argument("--write needs all rows of a case; leave --row out");
  return options;
}

std::vector<EngineRow> chosen_rows(const Options& options) {
  return options.row.empty() ? engine_rows() : std::vector<EngineRow>{engine_row(options.row)};
}

std::vector<Case> chosen_cases(const Options& options) {
  if (!options.id.empty()) return {find_case(options.id)};
  std::vector<Case> chosen;
  for (const Case& what : cases())
    if (what.takes_long == options.takes_long) chosen.push_back(what);
  return chosen;
}

bool is_not_for(const Case& what, const std::string& row) {
  const Expectation* expectation = find_expectation(what.id, row);
  return expectation && expectation->bounds.empty();
}

const char* mark(const Case& what, std::size_t i, const EngineRow& row, double result) {
  const bool right = result <= what.figures[i].demand(row.setting);
  if (right == is_expected_right(what, i, row)) return right ? "✓" : "✗";
  return right ? "✓!" : "✗!";
}

void print_demand(const Figure& figure) {
  const auto [order2, order4, order6] = figure.demands;
  std::printf(" ≤ %.3g", order2);
  if (order4 != order2 || order6 != order2) std::printf(" (order 4: %.3g, 6: %.3g)", order4, order6);
  std::printf(" |");
}

void print_head(const std::vector<EngineRow>& rows) {
  std::printf("| case | figure | right is |");
  for (const EngineRow& row : rows) std::printf(" %s |", row.name.c_str());
  std::printf("\n| --- | --- | --- |");
  for (std::size_t i = 0; i < rows.size(); ++i) std::printf(" --- |");
  std::printf("\n");
}

// Prints a case, with a column for each row. A row without figures is one that the case is not for.
void print_case(const Case& what, const std::vector<EngineRow>& rows) {
  std::vector<std::vector<double>> results;
  for (const EngineRow& row : rows)
    results.push_back(is_not_for(what, row.name) ? std::vector<double>() : run(what, row.setting));
  for (std::size_t i = 0; i < what.figures.size(); ++i) {
    const Figure& figure = what.figures[i];
    std::printf("| %s %s | %s |", i == 0 ? what.id : "", i == 0 ? what.claim : "", figure.name);
    print_demand(figure);
    for (std::size_t k = 0; k < rows.size(); ++k) {
      if (results[k].empty())
        std::printf(" – |");
      else
        std::printf(" %s %.2g |", mark(what, i, rows[k], results[k][i]), results[k][i]);
    }
    std::printf("\n");
  }
  std::fflush(stdout);
}

// Prints why the impulse engine is expected to miss figures of these cases.
void print_misses(const std::vector<Case>& chosen, const std::vector<EngineRow>& rows) {
  for (const Miss& miss : declared_misses()) {
    const bool is_shown =
        std::ranges::any_of(chosen, [&](const Case& what) { return std::string(what.id) == miss.id; }) &&
        std::ranges::any_of(rows, [&](const EngineRow& row) { return row.name == miss.row; });
    if (is_shown) std::printf("\n%s %s, %s: %s.\n", miss.id, miss.figure, miss.row, miss.reason);
  }
}

// Marks on the page show the expectations. Where the figures are better or worse than expected, the user is
// told to look at expectations.cc.
void compare(const Case& what, const std::string& row, const std::vector<double>& figures) {
  const bool reached = worst_share(what, row, figures) <= 1.0;
  if (reached == (expected_mark(what, row) == Mark::kReached)) return;
  std::fprintf(
      stderr,
      "physics_table: %s with %s %s the demand, but expectations.cc expects otherwise; correct it there\n",
      what.id, row.c_str(), reached ? "reaches" : "misses");
}

std::string measured_line(const Case& what) {
  Figures figures;
  for (const std::string& row : expected_rows()) {
    if (expected_mark(what, row) == Mark::kNotRun) continue;
    figures[row] = run(what, engine_row(row).setting);
    compare(what, row, figures[row]);
  }
  return table_line(what, figures);
}

void update_page(const std::vector<Case>& chosen) {
  // A missing row or block is found before minutes of computing.
  for (const std::string& row : expected_rows()) engine_row(row);
  for (const char* name : {"misses", "not run"}) block(read_page(kPage), name);
  auto lines = table_lines(block(read_page(kPage), "table"));
  for (const Case& what : chosen) {
    lines[what.id] = measured_line(what);
    std::fputs(lines[what.id].c_str(), stdout);
    std::fflush(stdout);
  }
  std::string table = table_head();
  for (const Case& what : cases()) table += lines[what.id];
  std::string page = with_block(read_page(kPage), "table", table);
  page = with_block(page, "not run", not_run_text());
  write_page(kPage, with_block(page, "misses", misses_text()));
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const Options options = parse(argc, argv);
    if (options.writes) {
      update_page(chosen_cases(options));
      return 0;
    }
    const auto rows = chosen_rows(options);
    const auto chosen = chosen_cases(options);
    print_head(rows);
    for (const Case& what : chosen) print_case(what, rows);
    print_misses(chosen, rows);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "physics_table: %s\n", error.what());
    return 2;
  }
}
