// Catches what a library prints.
#pragma once

#include <iostream>
#include <sstream>
#include <string>

namespace visum::scene {

// sdformat and its URDF parser print what they dislike. This catches their output for our own message. It
// redirects the process's streams, which is safe because one thread reads scenes before the first tick.
class ConsoleCapture {
 public:
  ConsoleCapture() : cerr_(std::cerr.rdbuf(text_.rdbuf())), cout_(std::cout.rdbuf(text_.rdbuf())) {}
  ~ConsoleCapture() {
    std::cerr.rdbuf(cerr_);
    std::cout.rdbuf(cout_);
  }
  ConsoleCapture(const ConsoleCapture&) = delete;
  ConsoleCapture& operator=(const ConsoleCapture&) = delete;

  // The first line that is about the model.
  std::string first_line() {
    for (std::string line; std::getline(text_, line);)
      if (line.find("log file") == std::string::npos && line.find("HOME") == std::string::npos) return line;
    return "";
  }

 private:
  std::stringstream text_;
  std::streambuf* cerr_;
  std::streambuf* cout_;
};

}  // namespace visum::scene
