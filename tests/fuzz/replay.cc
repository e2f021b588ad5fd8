// Runs a fuzz target without libFuzzer: once over every file of the given folders and then, if asked for,
// over new random inputs made from them. The same seed and number give the same input. If an input ends the
// process, the command line that runs this input alone is printed.
//   fuzz_x_replay [--seconds S] [--seed N] [--first I] [--inputs COUNT] FOLDERS...
#include <signal.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <random>
#include <vector>

#include "tests/fuzz/mutator.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
extern "C" __attribute__((weak)) void __sanitizer_set_death_callback(void (*callback)());

namespace {

using visum::testing::Input;
using visum::testing::Mutator;
using Clock = std::chrono::steady_clock;

constexpr unsigned kLongestInput_s = 60;  // a guard against hanging, not a measure

std::string how_to_run_it_alone;  // for the current input

void tell_of_the_input() {
  [[maybe_unused]] const auto written =
      ::write(STDERR_FILENO, how_to_run_it_alone.data(), how_to_run_it_alone.size());
}

void on_end(int number) {
  tell_of_the_input();
  ::signal(number, SIG_DFL);
  ::raise(number);
}

void watch_for_ends() {
  for (const int number : {SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGALRM}) ::signal(number, on_end);
  if (__sanitizer_set_death_callback) __sanitizer_set_death_callback(tell_of_the_input);
}

void run(const Input& input) {
  ::alarm(kLongestInput_s);
  LLVMFuzzerTestOneInput(input.data(), input.size());
  ::alarm(0);
}

std::vector<Input> replay(const std::vector<std::string>& folders) {
  std::vector<Input> inputs;
  for (const auto& folder : folders)
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
      if (!entry.is_regular_file()) continue;
      std::ifstream file(entry.path(), std::ios::binary);
      const std::vector<char> bytes(std::istreambuf_iterator<char>(file), {});
      how_to_run_it_alone = "failed: " + entry.path().string() + "\n";
      run(inputs.emplace_back(bytes.begin(), bytes.end()));
    }
  return inputs;
}

struct Options {
  std::vector<std::string> folders;
  double seconds = 0.0;
  std::uint64_t seed = std::random_device()();
  std::uint64_t first = 0;
  std::uint64_t inputs = 0;
};

std::uint64_t make_new_ones(const Options& options, std::vector<Input> corpus, const std::string& program) {
  // Sorted, because file systems list files in different orders. Without <=>, because GCC 12 warns at -O3
  // that it might compare too much.
  std::sort(corpus.begin(), corpus.end(), [](const Input& a, const Input& b) {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
  });
  const Mutator mutator(std::move(corpus), options.seed);
  const auto until = Clock::now() + std::chrono::duration<double>(options.seconds);
  std::string folders;
  for (const auto& folder : options.folders) folders += " " + folder;
  std::uint64_t number = options.first;
  for (; number < options.first + options.inputs || Clock::now() < until; ++number) {
    how_to_run_it_alone = "failed: " + program + " --seed " + std::to_string(options.seed) + " --first " +
                          std::to_string(number) + " --inputs 1" + folders + "\n";
    run(mutator.input(number));
  }
  return number - options.first;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app{"Runs a fuzz target over files, and over new inputs made of them"};
  app.add_option("folders", options.folders)->required()->check(CLI::ExistingDirectory);
  app.add_option("--seconds", options.seconds, "makes new inputs for so long");
  app.add_option("--seed", options.seed, "of the new inputs; default: another one each time");
  app.add_option("--first", options.first, "number of the first new input");
  app.add_option("--inputs", options.inputs, "so many new inputs at least");
  CLI11_PARSE(app, argc, argv);
  watch_for_ends();
  auto corpus = replay(options.folders);
  if (corpus.empty()) {
    std::cerr << "no file to replay\n";
    return 1;
  }
  std::cout << corpus.size() << " inputs" << std::endl;
  if (options.seconds <= 0.0 && options.inputs == 0) return 0;
  const auto made = make_new_ones(options, std::move(corpus), argv[0]);
  std::cout << made << " new inputs of seed " << options.seed << ", no findings\n";
}
