#include "clients/examples/pick_and_place/options.h"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

namespace visum::pick_and_place {
namespace {

constexpr int kBadUsage = 2;

// Finds the arm's URDF: in the source tree or installation of this binary, or in the working directory's
// models. Empty if it is not there.
std::string default_urdf() {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::path binary = fs::read_symlink("/proc/self/exe", error);
  for (fs::path folder = binary.parent_path(); folder.has_relative_path(); folder = folder.parent_path()) {
    for (const char* place : {"models", "share/visum/models"}) {
      const fs::path file = folder / place / "amtec_arm" / "amtec_arm.urdf";
      if (fs::exists(file, error)) return file.string();
    }
  }
  const fs::path here = fs::path("models") / "amtec_arm" / "amtec_arm.urdf";
  return fs::exists(here, error) ? here.string() : std::string();
}

// Like CLI::Range, but refuses NaN.
CLI::Validator between(double minimum, double maximum) {
  char text[64];
  std::snprintf(text, sizeof text, "from %g to %g", minimum, maximum);
  const std::string range = text;
  return {[=](const std::string& word) {
            double value = 0.0;
            if (!CLI::detail::lexical_cast(word, value)) return "'" + word + "' is no number";
            return value >= minimum && value <= maximum ? std::string() : "'" + word + "' is not " + range;
          },
          range};
}

Eigen::Vector3d to_place(const std::vector<double>& numbers, double table) {
  return {numbers[0], numbers[1], numbers.size() > 2 ? numbers[2] : table};
}

}  // namespace

ParsedOptions parse_options(int argc, const char* const* argv) {
  ParsedOptions parsed;
  Options& o = parsed.options;
  o.urdf = default_urdf();
  std::vector<double> from{0.5, 0.2}, to{0.5, -0.2};
  double table = 0.2;
  const CLI::Validator length = between(0.001, 10.0);

  CLI::App app(
      "Picks a box up and puts it down elsewhere, with an arm that is served as a hardware part.\n"
      "Places are in metres, in the frame of the arm's base.");
  app.name("visum-pick-and-place");
  app.set_version_flag("--version", "visum-pick-and-place 0.2.0");
  app.add_option("--connect", o.connect, "server, HOST:PORT")->capture_default_str();
  app.add_option("--part", o.part, "name of the arm")->capture_default_str();
  app.add_option("--urdf", o.urdf, "the arm's model")->capture_default_str()->required(o.urdf.empty());
  app.add_option("--token-file", o.token_file, "for a server that demands a token");
  app.add_option("--from", from, "x,y[,z] where the box stands; z of the surface below it")
      ->delimiter(',')
      ->expected(2, 3)
      ->check(between(-10.0, 10.0))
      ->capture_default_str();
  app.add_option("--to", to, "x,y[,z] where to put it")
      ->delimiter(',')
      ->expected(2, 3)
      ->check(between(-10.0, 10.0))
      ->capture_default_str();
  app.add_option("--table", table, "z of the surface, where a place has none")
      ->check(between(-10.0, 10.0))
      ->capture_default_str();
  app.add_option("--width", o.job.width, "of the box")->check(length)->capture_default_str();
  app.add_option("--height", o.job.height, "of the box")->check(length)->capture_default_str();
  app.add_option("--yaw", o.job.yaw, "of the box about z [rad]")
      ->check(between(-7.0, 7.0))
      ->capture_default_str();
  app.add_option("--lift", o.job.lift, "how high to lift it")->check(length)->capture_default_str();
  app.add_option("--speed", o.speed, "share of the drives' maximum speeds")
      ->check(between(0.05, 0.95))
      ->capture_default_str();
  app.add_option("--acceleration", o.acceleration, "of every joint, at most [rad/s^2]")
      ->check(between(0.05, 10.0))
      ->capture_default_str();
  app.footer(
      "Example:\n  visum-pick-and-place --connect 127.0.0.1:1500 --from 0.5,0.2 --to 0.5,-0.2\n\n"
      "Exit codes: 0 done, 1 not possible or failed, 2 bad usage, 4 connection lost, 130 interrupted.");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    parsed.exit_code = app.exit(error) == 0 ? 0 : kBadUsage;
  }
  o.job.from = to_place(from, table);
  o.job.to = to_place(to, table);
  return parsed;
}

}  // namespace visum::pick_and_place
