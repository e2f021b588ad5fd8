#include "clients/visum/exec/device_place.h"

#include <fcntl.h>
#include <sched.h>
#include <sys/mount.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <stdexcept>

namespace visum::exec {
namespace {

namespace fs = std::filesystem;

constexpr const char* kDevices = "/dev";

[[noreturn]] void fail(const std::string& what, int error) {
  throw std::runtime_error(what + ": " + std::strerror(error));
}

[[noreturn]] void fail(const std::string& what) {
  fail(what, errno);
}

void write_proc(const char* path, const std::string& text) {
  std::ofstream file(path);
  file << text << std::flush;
  if (!file) fail(std::string("cannot write ") + path);
}

// Without root rights the process first enters a user namespace of its own, in which its ids stay the same.
void enter_namespace() {
  if (::unshare(CLONE_NEWNS) == 0) return;
  const auto uid = std::to_string(::getuid()), gid = std::to_string(::getgid());
  if (::unshare(CLONE_NEWUSER | CLONE_NEWNS) != 0) {
    fail(
        "a device can only be put elsewhere in a private mount namespace, which takes root (CAP_SYS_ADMIN) "
        "or a kernel "
        "that gives every user a user namespace (sysctl kernel.unprivileged_userns_clone=1); a container may "
        "forbid "
        "both");
  }
  write_proc("/proc/self/setgroups", "deny");
  write_proc("/proc/self/uid_map", uid + " " + uid + " 1");
  write_proc("/proc/self/gid_map", gid + " " + gid + " 1");
}

// Not called "bind": std::bind would match some arguments better.
void bind_mount(const std::string& source, const std::string& target, unsigned long flags = 0) {
  if (::mount(source.c_str(), target.c_str(), nullptr, MS_BIND | flags, nullptr) != 0)
    fail("cannot put " + source + " to " + target);
}

void make_empty(const std::string& path) {
  const int fd = ::open(path.c_str(), O_CREAT | O_WRONLY | O_CLOEXEC, 0666);
  if (fd < 0) fail("cannot make " + path);
  ::close(fd);
}

// Puts one entry of /dev into the copy: a link as it is, anything else by a bind mount.
void copy_entry(const fs::directory_entry& entry, const std::string& from) {
  const auto name = entry.path().filename().string();
  const auto target = std::string(kDevices) + "/" + name;
  const auto source = from + "/" + name;
  if (entry.is_symlink()) return fs::create_symlink(fs::read_symlink(entry.path()), target);
  if (entry.is_directory())
    fs::create_directory(target);
  else
    make_empty(target);
  bind_mount(source, target, MS_REC);
}

// Replaces /dev by a folder of our own with the same entries, in which new names can be made.
void copy_devices() {
  const int old = ::open(kDevices, O_PATH | O_DIRECTORY | O_CLOEXEC);
  if (old < 0) fail("cannot open /dev");
  const auto from = "/proc/self/fd/" + std::to_string(old);
  std::vector<fs::directory_entry> entries;
  for (const auto& entry : fs::directory_iterator(from)) entries.push_back(entry);
  if (::mount("visum", kDevices, "tmpfs", MS_NOSUID, "mode=755") != 0) fail("cannot make a place in /dev");
  for (const auto& entry : entries) copy_entry(entry, from);
  ::close(old);
}

bool exists(const std::string& path) {
  struct stat status {};
  return ::stat(path.c_str(), &status) == 0;
}

}  // namespace

void place_devices(const std::vector<Placement>& placements) {
  for (const auto& [device, source] : placements)
    if (!exists(source)) fail("there is no " + source, ENOENT);
  enter_namespace();
  if (::mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) != 0)
    fail("cannot make the mounts private");
  bool copied = false;
  for (const auto& [device, source] : placements) {
    if (!exists(device)) {
      if (!copied) copy_devices();
      copied = true;
      make_empty(device);
    }
    bind_mount(source, device);
  }
}

}  // namespace visum::exec
