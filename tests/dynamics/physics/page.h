// The suite on pages of Markdown, between comments that name the block: what each engine row misses, which
// case is not for which row, and the table. physics_table --write puts it there; page_test.cc compares it
// with expectations.cc, so that only the figures beside the marks are of the day on which it was written.
#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "tests/dynamics/physics/case.h"

namespace visum::physics {

// From the source's root.
inline constexpr const char* kTablePage = "tests/dynamics/physics/README.md";
inline constexpr std::array kPagesWithMisses{kTablePage, "server/dynamics/impulse/README.md", "README.md"};

// A page of the source tree; both throw std::runtime_error where it cannot be read or written.
std::string read_page(const std::string& path);
void write_page(const std::string& path, const std::string& text);

// What stands between the comments of a block. Throws std::runtime_error where the page has none.
std::string block(const std::string& page, const std::string& name);
std::string with_block(const std::string& page, const std::string& name, const std::string& text);

enum class Mark { kReached, kMissed, kNotRun };
// A case is reached where no bound of expectations.cc is above what the case demands.
Mark expected_mark(const Case& what, const std::string& row);
std::string text_of(Mark mark);

// Those that expectations.cc speaks of, whether this build has their engine or not.
std::vector<std::string> expected_rows();

// From cases and expectations alone.
std::string misses_text();
std::string not_run_text();
std::string table_head();
std::string line_start(const Case& what);  // all of its line but the marks

using Figures = std::map<std::string, std::vector<double>>;  // by row; none where the case is not for it
std::string table_line(const Case& what, const Figures& figures);
// The largest figure in units of what is demanded; infinite where that is 0 and the figure is not.
double worst_share(const Case& what, const std::string& row, const std::vector<double>& figures);

// The lines of a block that holds the table, by case.
std::map<std::string, std::string> table_lines(const std::string& table);
// A line's marks, without figures, by row.
std::vector<std::string> marks_of(const std::string& line);

}  // namespace visum::physics
