// How a program of Visum ends. Where its standard output cannot be written, as on a full disk, it says so and
// its exit code is not 0. Main thread only.
#pragma once

#include <string>
#include <string_view>

namespace visum::command_line {

constexpr int kOutputLost = 1;  // the exit code of a program that did its work and could not print it

// Writes out all that waits for standard output. Returns why something of it is lost; empty: all is written.
// A reader that closes the pipe early, as `| head` does, has seen enough: that is no loss.
std::string find_lost_output();

// The last line of each main(): returns the exit code for a program whose work ended with `code`. If output
// is lost, it says so on stderr, and a code of 0 becomes kOutputLost.
int finish(std::string_view program, int code);

// Ends the process behind finish() without what comes after main(): the destructors of static objects and of
// some sixty libraries, which nobody sees. Logs must be written. With a sanitizer it ends in the ordinary
// way, so that leaks are found.
[[noreturn]] void leave(int code);

}  // namespace visum::command_line
