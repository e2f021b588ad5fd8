// physics_table: runs the suite's cases and prints what came out as a table in Markdown, beside what is
// demanded: ✓ right, ✗ wrong, and with "!" where expectations.cc has it otherwise. usage: physics_table
// [--long] [--case ID] [--row ROW]
#include <algorithm>
#include <cstdio>
#include <cstring>
#include <stdexcept>

#include "tests/dynamics/physics/case.h"
#include "tests/dynamics/physics/engine_rows.h"
#include "tests/dynamics/physics/expectations.h"

namespace {

using namespace visum::physics;

struct Options {
  bool takes_long = false;
  std::string id, row;  // empty: all
};

Options parse(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string option = argv[i];
    if (option == "--long") {
      options.takes_long = true;
    } else if ((option == "--case" || option == "--row") && i + 1 < argc) {
      (option == "--case" ? options.id : options.row) = argv[++i];
    } else {
      throw std::invalid_argument("usage: physics_table [--long] [--case ID] [--row ROW]");
    }
  }
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

bool is_not_for(const Case& what, const EngineRow& row) {
  const Expectation* expectation = find_expectation(what.id, row.name);
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

// By row; a row without figures is not for this engine.
void print_case(const Case& what, const std::vector<EngineRow>& rows) {
  std::vector<std::vector<double>> results;
  for (const EngineRow& row : rows)
    results.push_back(is_not_for(what, row) ? std::vector<double>() : run(what, row.setting));
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

// Why, where the impulse engine is expected to miss a figure of these cases.
void print_misses(const std::vector<Case>& chosen, const std::vector<EngineRow>& rows) {
  for (const Miss& miss : declared_misses()) {
    const bool is_shown =
        std::ranges::any_of(chosen, [&](const Case& what) { return std::string(what.id) == miss.id; }) &&
        std::ranges::any_of(rows, [&](const EngineRow& row) { return row.name == miss.row; });
    if (is_shown) std::printf("\n%s %s, %s: %s.\n", miss.id, miss.figure, miss.row, miss.reason);
  }
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const Options options = parse(argc, argv);
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
