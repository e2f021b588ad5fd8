// The checks are pure functions from a source tree to a list of findings. Each finding is one line of text:
// "path:line: the fault, and the remedy".
#pragma once

#include <string>
#include <vector>

#include "tests/architecture/source_tree.h"

namespace visum::architecture {

using Findings = std::vector<std::string>;

Findings check_finds_files(const SourceTree& tree);  // every folder that must hold code does
Findings check_top_level(const SourceTree& tree);    // nothing in the root that is not listed
Findings check_includes_resolve(
    const SourceTree& tree);                    // every "quoted" include is a file of the tree, from the root
Findings check_layers(const SourceTree& tree);  // includes follow the arrows
Findings check_folder_cycles(
    const SourceTree& tree);  // no folders that include each other, over any number of steps
Findings check_file_cycles(const SourceTree& tree);    // nor files
Findings check_third_parties(const SourceTree& tree);  // wrapped libraries stay in the folder that wraps them
Findings check_pragma_once(const SourceTree& tree);
Findings check_file_lengths(const SourceTree& tree);
Findings check_function_lengths(const SourceTree& tree);  // C++, by braces: an approximation
Findings check_unfinished_words(const SourceTree& tree);
Findings check_models_are_data(const SourceTree& tree);
Findings check_comment_openings(
    const SourceTree& tree);                            // no comment begins with a word of banned_openings()
Findings check_comment_widths(const SourceTree& tree);  // comments are at most kMaxCommentColumns wide
Findings check_page_widths(const SourceTree& tree);     // so is prose in Markdown, at kMaxPageColumns

// A function definition found by its braces.
struct FunctionSpan {
  int first_line;  // of the opening brace
  int last_line;
};
std::vector<FunctionSpan> find_functions(const SourceFile& file);

}  // namespace visum::architecture
