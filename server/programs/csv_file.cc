#include "server/programs/csv_file.h"

#include <spdlog/spdlog.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <stdexcept>
#include <system_error>

#include "protocol/config/new_file.h"
#include "server/programs/program.h"

namespace visum::programs {

int export_ports(const std::string& file, const recording::CsvOptions& options, const std::string& to) {
  std::error_code not_there;
  if (std::filesystem::equivalent(file, to, not_there))
    throw std::runtime_error("--output " + to + " is the recording itself: name another file");
  const config::NewFile made(to);
  std::ofstream out_file;
  if (!to.empty()) out_file.open(made.path(), std::ios::binary | std::ios::trunc);
  std::ostream& out = to.empty() ? std::cout : out_file;
  if (!out) throw std::runtime_error(to + ": cannot be written: " + std::strerror(errno));
  const auto result = recording::export_csv(file, options, out);
  errno = 0;
  if (!out.flush() && !to.empty())  // standard output is looked at in the end (output.h)
    throw std::runtime_error(to + ": cannot be written" +
                             (errno == 0 ? std::string() : std::string(": ") + std::strerror(errno)));
  made.keep();
  if (result.damage.empty()) return kPassed;
  spdlog::error("{}: {} rows, then it is damaged: {}", file, result.rows, result.damage);
  return kFailed;
}

}  // namespace visum::programs
