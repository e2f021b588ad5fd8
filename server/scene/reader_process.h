// Runs a program that reads a file, in a process of its own: it may fail, die, hang, or write without end.
#pragma once

#include <chrono>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace visum::scene {

struct ReaderBounds {
  std::chrono::milliseconds deadline;  // by the wall clock
  std::size_t answer_bytes;
  const char* answer = "triangles";  // what the answer consists of, for messages
};

// Runs `program` with a file's bytes on its standard input and returns its standard output. None of our files
// is open in it. Throws std::runtime_error if it does not succeed in time. The text is the first line of its
// standard error, or says what became of it.
std::string run_reader(const std::string& program, std::string_view input, const ReaderBounds& bounds);

// Runs a program of the user with arguments and our environment, without a shell and without input. The rest
// is as with run_reader().
std::string run_program(const std::vector<std::string>& words, const ReaderBounds& bounds);

}  // namespace visum::scene
