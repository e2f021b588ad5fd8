// The memory that the scheduler shares with the shim (clients/shim/channel.h): a file of our own, mapped here
// and in every process of the program.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "clients/shim/channel.h"
#include "clients/visum/common/temp_folder.h"

namespace visum::exec {

class TimeChannel {
 public:
  // Throws ExitError(kFailed) where the file cannot be made.
  explicit TimeChannel(std::int64_t tick_ns);
  ~TimeChannel();
  TimeChannel(const TimeChannel&) = delete;
  TimeChannel& operator=(const TimeChannel&) = delete;

  shim::Shared& memory() { return *memory_; }
  std::span<shim::Slot> slots() { return {memory_->slots, memory_->used.load()}; }

  // Call these before the program starts: the devices and ports that lead to the world.
  void add_tty(dev_t device);
  void add_port(std::uint16_t port);
  void set_session_port(std::uint16_t port) { memory_->session_port = port; }
  // Sets the variables by which the program finds the channel and the shim.
  void export_to_environment() const;

 private:
  cli::TempFolder folder_;
  std::filesystem::path path_;
  shim::Shared* memory_ = nullptr;
};

}  // namespace visum::exec
