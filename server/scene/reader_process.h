// Runs a program over a file, in a process that may fail, die, hang or talk without end.
#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <string>

namespace visum::scene {

struct ReaderBounds {
  std::chrono::milliseconds deadline;  // by the wall clock
  std::size_t answer_bytes;
};

// What `program` writes on its standard output with `file` on its standard input. Nothing else of ours is
// open in it. Throws std::runtime_error where it does not end with success in time: its own words (the first
// line of what it writes on standard error) or what became of it.
std::string run_reader(const std::string& program, const std::filesystem::path& file,
                       const ReaderBounds& bounds);

}  // namespace visum::scene
