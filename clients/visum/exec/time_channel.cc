#include "clients/visum/exec/time_channel.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <new>

#include "clients/shim/namespaces.h"
#include "clients/visum/common/exit_code.h"
#include "clients/visum/exec/preload.h"

namespace visum::exec {
namespace {

void* map_new_file(const std::filesystem::path& path, std::size_t size) {
  const int fd = ::open(path.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  void* memory = MAP_FAILED;
  if (fd >= 0 && ::ftruncate(fd, static_cast<off_t>(size)) == 0)
    memory = ::mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
  const int error = errno;
  if (fd >= 0) ::close(fd);
  if (memory == MAP_FAILED)
    throw cli::ExitError(cli::kFailed,
                         "cannot share memory at " + path.string() + ": " + std::strerror(error));
  return memory;
}

}  // namespace

TimeChannel::TimeChannel(std::int64_t tick_ns)
    : path_(folder_.path() / "time"),
      memory_(new (map_new_file(path_, sizeof(shim::Shared))) shim::Shared{}) {
  memory_->tick_ns = tick_ns;
  memory_->scheduler = ::getpid();
  memory_->pid_namespace = shim::pid_namespace();
  memory_->magic = shim::kMagic;
}

TimeChannel::~TimeChannel() {
  ::munmap(memory_, sizeof(shim::Shared));
}

void TimeChannel::add_tty(dev_t device) {
  if (memory_->tty_count < shim::kMostBuses) memory_->ttys[memory_->tty_count++] = device;
}

void TimeChannel::add_port(std::uint16_t port) {
  if (memory_->port_count < shim::kMostBuses) memory_->ports[memory_->port_count++] = port;
}

void TimeChannel::export_to_environment() const {
  preload("visum-shim", "libvisum-shim.so", folder_.path());
  ::setenv(shim::kVariable, path_.c_str(), 1);
}

}  // namespace visum::exec
