#include "clients/visum/run/spare_recording.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <string>
#include <system_error>

#include "protocol/config/new_file.h"

namespace visum::run {
namespace {

std::filesystem::path numbered(const std::filesystem::path& file, int number) {
  if (number == 1) return file;
  return config::name_beside(file.parent_path() / file.stem(),
                             "_" + std::to_string(number) + file.extension().string());
}

}  // namespace

SpareRecording::SpareRecording(std::filesystem::path wanted) : wanted_(std::move(wanted)) {
  path_ = config::name_beside(wanted_.parent_path() / ("." + wanted_.filename().string()),
                              "." + std::to_string(::getpid()));
  const int fd = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0644);
  if (fd < 0) throw std::system_error(errno, std::generic_category(), wanted_.parent_path().string());
  ::close(fd);
}

SpareRecording::~SpareRecording() {
  std::error_code none;
  if (kept_.empty()) std::filesystem::remove(path_, none);
}

std::filesystem::path SpareRecording::keep() {
  std::error_code error;
  if (!kept_.empty() || std::filesystem::file_size(path_, error) == 0 || error) return kept_;
  for (int number = 1; kept_.empty(); ++number) {
    const auto name = numbered(wanted_, number);
    // Unlike rename(), a link never replaces a file, even one that another process made a moment ago.
    std::filesystem::create_hard_link(path_, name, error);
    if (error == std::errc::file_exists) continue;
    if (!error)
      std::filesystem::remove(path_, error);
    else if (std::error_code none; std::filesystem::exists(name, none))
      continue;
    else if (std::filesystem::rename(path_, name, error); error)  // a file system without links
      return {};
    kept_ = name;
  }
  return kept_;
}

}  // namespace visum::run
