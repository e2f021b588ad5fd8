// The suite's page in Markdown. Three blocks of it are generated, between comments that name the block: what
// each engine row misses, which case is not for which row, and the table. `physics_table --write` writes
// them. page_test.cc compares them with expectations.cc, so only the figures beside the marks can be out of
// date.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "tests/dynamics/physics/case.h"

namespace visum::physics {

// The page, from the source's root.
inline constexpr const char* kPage = "tests/dynamics/physics/README.md";

// A page of the source tree. Both throw std::runtime_error if it cannot be read or written.
std::string read_page(const std::string& path);
void write_page(const std::string& path, const std::string& text);

// The text between the comments of a block. Throws std::runtime_error if the page has no such block.
std::string block(const std::string& page, const std::string& name);
std::string with_block(const std::string& page, const std::string& name, const std::string& text);

enum class Mark { kReached, kMissed, kNotRun };
// A case is reached if no bound of expectations.cc is above the case's demand.
Mark expected_mark(const Case& what, const std::string& row);
std::string text_of(Mark mark);

// The rows in expectations.cc, whether this build has their engine or not.
std::vector<std::string> expected_rows();

// The texts of the blocks, from cases and expectations alone. Lists are wrapped at 100 columns.
std::string misses_text();
std::string not_run_text();
std::string table_head();
std::string line_start(const Case& what);  // its line without the marks

using Figures = std::map<std::string, std::vector<double>>;  // by row; none if the case is not for it
std::string table_line(const Case& what, const Figures& figures);
// The largest figure in units of its demand; infinite if the demand is 0 and the figure is not.
double worst_share(const Case& what, const std::string& row, const std::vector<double>& figures);

// The lines of the table's block, by case.
std::map<std::string, std::string> table_lines(const std::string& table);
// A line's marks, without figures, by row.
std::vector<std::string> marks_of(const std::string& line);

}  // namespace visum::physics
