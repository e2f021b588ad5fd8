#include "clients/mca/options.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <stdexcept>

#include "clients/mca/announce.h"
#include "clients/mca/part.h"
#include "protocol/command_line/output.h"
#include "protocol/command_line/parse.h"
#include "protocol/config/config.h"
#include "protocol/config/unknown_name.h"

namespace visum::mca {
namespace {

constexpr std::int64_t kLongestPeriod_ns = 1'000'000'000'000;
constexpr int kMostUppers = 32;

void collect(Module& module, std::vector<std::string>& paths) {
  paths.push_back(module.path());
  if (auto* group = dynamic_cast<Group*>(&module))
    for (const auto& member : group->members()) collect(*member, paths);
}

ParameterValue value_of(const config::Node& node, const ParameterValue& like) {
  if (std::holds_alternative<double>(like)) return node.number();
  if (std::holds_alternative<std::int64_t>(like)) return node.integer();
  if (std::holds_alternative<bool>(like)) return node.boolean();
  return node.text();
}

void apply(const config::Node& settings, const Module& module) {
  std::vector<std::string> names;
  for (const ParameterBase* parameter : module.parameters()) names.push_back(parameter->name());
  for (const auto& key : settings.keys()) {
    const auto node = *settings.find(key);
    const auto found = std::ranges::find(names, key);
    if (found == names.end())
      throw config::ConfigError(node.place(), config::unknown_name("parameter", key, names));
    ParameterBase& parameter = *module.parameters()[static_cast<std::size_t>(found - names.begin())];
    const std::string why = parameter.set(value_of(node, parameter.value()));
    if (!why.empty()) throw config::ConfigError(node.place(), why);
  }
}

void declare_loop(CLI::App& app, Options& options, std::string& period) {
  app.add_option("--period", period, "the period of the cycle: 0.01s, 10ms or 250us");
  app.add_option("--timescale", options.time_scale,
                 "how much slower it runs: 2 turns a period of 10 ms into 20 ms; LoopTime() does not know")
      ->capture_default_str()
      ->check(CLI::Range(1e-3, 1e6));
  app.add_option("--debuglevel", options.debug_level, "show debug lines up to this level; 0: none")
      ->capture_default_str()
      ->check(CLI::Range(0, 9));
  app.add_option("--debugdomains", options.domains, "of these domains only; default: of all")->delimiter(',');
  app.add_option("--debugmodules", options.modules, "show all debug lines of these modules, by path")
      ->delimiter(',');
  app.add_option("--configfile", options.config_file, "a YAML file with parameters, by module");
  app.add_option("--versioncheck", options.version_check,
                 "HOST:PORT of another part or of a server: end if it has another version");
}

void declare_neighbours(CLI::App& app, Options& options, std::vector<std::string>& uppers) {
  app.add_option("--name", options.name, "the part's name for other parts and for tools")
      ->capture_default_str();
  app.add_option("--lower", options.lower,
                 "PART@HOST:PORT, a part below: the server of a hardware part, or a server that knows where "
                 "the part PART of a controller is; repeatable. The first one gives time and sensor values, "
                 "all are commanded");
  app.add_option("--port", options.port, "TCP port for the parts above; 0: any free one; default: none")
      ->check(CLI::Range(0, 65535));
  app.add_option("--uppers", uppers,
                 "in lockstep, with --port: the parts above to wait for: how many (0 to 32), or their names")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->default_str("1");
  app.add_option("--join-timeout", options.join_timeout_s,
                 "in lockstep: seconds that the parts above may take to join")
      ->capture_default_str()
      ->check(CLI::Range(1e-3, 1e6));
  app.add_option("--upper-timeout", options.upper_timeout_s,
                 "in lockstep: seconds that a part above may take for a cycle before it counts as lost")
      ->capture_default_str()
      ->check(CLI::Range(1e-3, 1e6));
  app.add_option("--connect-timeout", options.connect_timeout_s, "seconds to wait for the parts below")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 1e6));
  app.add_option("--token-file", options.token_file, "a file with the token, for servers that ask for one");
}

// One word of digits is a number, all others are names.
void read_uppers(const std::vector<std::string>& words, Options& options) {
  if (words.empty()) return;
  int count = 0;
  const std::string& first = words.front();
  const auto [end, error] = std::from_chars(first.data(), first.data() + first.size(), count);
  const bool is_number = words.size() == 1 && end == first.data() + first.size() && error == std::errc();
  if (is_number && (count < 0 || count > kMostUppers))
    throw std::invalid_argument("--uppers: " + first + " is not in 0 .. " + std::to_string(kMostUppers));
  if (words.size() > kMostUppers || std::ranges::find(words, "") != words.end())
    throw std::invalid_argument("--uppers: give a number, or up to " + std::to_string(kMostUppers) +
                                " names, as task,monitor");
  options.uppers = is_number ? count : static_cast<int>(words.size());
  if (!is_number) options.upper_names = words;
}

}  // namespace

std::int64_t period_of(const std::string& text) {
  double number = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  const std::string unit(end, text.data() + text.size());
  const double scale = unit == "s" ? 1e9 : unit == "ms" ? 1e6 : unit == "us" || unit == "\u00b5s" ? 1e3 : 0.0;
  const double ns = std::round(number * scale);
  if (error != std::errc() || !(ns >= 1000.0 && ns <= static_cast<double>(kLongestPeriod_ns)))
    throw std::invalid_argument("--period: '" + text +
                                "' is no period; give 0.01s, 10ms or 250us, at least 1us");
  return static_cast<std::int64_t>(ns);
}

std::optional<int> parse(const std::string& about, int argc, const char* const* argv, Options& options) {
  const std::string name = std::filesystem::path(argc > 0 ? argv[0] : "part").filename();
  CLI::App app{about, name};
  std::string period;
  std::vector<std::string> uppers;
  declare_loop(app, options, period);
  declare_neighbours(app, options, uppers);
  command_line::add_version(app);
  app.footer(
      "Example:\n  " + name +
      " --lower arm@127.0.0.1:1500 --period 5ms --port 0\n\n"
      "Exit codes: 1 refused, 2 bad usage, 3 bad configuration file, 4 a part above or below was lost, 130 "
      "interrupted.");
  if (const auto code = command_line::parse(app, argc, argv)) return code;
  try {
    if (!period.empty()) options.period_ns = period_of(period);
    read_uppers(uppers, options);
  } catch (const std::invalid_argument& error) {
    std::fprintf(stderr, "%s: %s\n", name.c_str(), error.what());
    return command_line::kBadUsage;
  }
  return {};
}

void apply_config_file(const std::string& file, Group& part) {
  const auto root = config::load_file(file);
  std::vector<std::string> paths;
  collect(part, paths);
  paths.front() = part.name();
  for (const auto& key : root.keys()) {
    const auto settings = *root.find(key);
    if (std::ranges::find(paths, key) == paths.end())
      throw config::ConfigError(settings.place(), config::unknown_name("module", key, paths));
    apply(settings, *find_module(dynamic_cast<Part&>(part), key == part.name() ? "" : key));
  }
}

}  // namespace visum::mca
