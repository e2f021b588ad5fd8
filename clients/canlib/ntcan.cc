// The part of esd's libntcan that programs for PowerCube modules use, over a bus of Visum's.
#include "clients/canlib/ntcan.h"

#include <algorithm>
#include <array>
#include <memory>
#include <mutex>

#include "clients/canlib/can_line.h"

namespace {

using visum::canlib::CanLine;
using visum::canlib::Frame;

struct Opened {
  std::unique_ptr<CanLine> line;
  std::chrono::milliseconds rx_timeout{};
  uint32_t baud = NTCAN_BAUD_250;
};

constexpr std::size_t kMostHandles = 64;
std::mutex table_lock;
std::array<std::shared_ptr<Opened>, kMostHandles> table;  // a handle is its place, from 1

std::shared_ptr<Opened> find(NTCAN_HANDLE handle) {
  const std::lock_guard lock(table_lock);
  if (handle < 1 || handle > static_cast<NTCAN_HANDLE>(kMostHandles)) return nullptr;
  return table[static_cast<std::size_t>(handle) - 1];
}

CMSG to_message(const Frame& frame) {
  CMSG message{};
  message.id = static_cast<int32_t>(frame.id);
  message.len = frame.size;
  for (std::size_t i = 0; i < frame.size; ++i) message.data[i] = frame.data[i];
  return message;
}

// Waits for the first message until `due`, and takes those that are there behind it.
NTCAN_RESULT receive(CanLine& line, CMSG* messages, int32_t* count, CanLine::Clock::time_point due) {
  const int32_t room = *count;
  *count = 0;
  while (*count < room) {
    const auto frame = line.read(*count == 0 ? due : CanLine::Clock::time_point{});
    if (!frame) break;
    messages[*count] = to_message(*frame);
    messages[(*count)++].msg_lost = static_cast<uint8_t>(std::min(line.take_lost(), 255U));
  }
  if (*count > 0) return NTCAN_SUCCESS;
  return line.gone() ? NTCAN_CONTR_OFF_BUS : NTCAN_RX_TIMEOUT;
}

// Programs pass the count of their last call again, which may have been 0: there is nothing to do then.
bool has_room(const CMSG* messages, const int32_t* count) {
  return count && *count >= 0 && (messages || *count == 0);
}

}  // namespace

NTCAN_RESULT canOpen(int32_t, uint32_t, int32_t, int32_t, int32_t, int32_t rx_timeout, NTCAN_HANDLE* handle) {
  if (!handle) return NTCAN_INVALID_PARAMETER;
  auto line = CanLine::open("libntcan (Visum)");
  if (!line) return NTCAN_NET_NOT_FOUND;
  const std::lock_guard lock(table_lock);
  for (std::size_t i = 0; i < kMostHandles; ++i) {
    if (table[i]) continue;
    table[i] = std::make_shared<Opened>();
    table[i]->line = std::move(line);
    table[i]->rx_timeout = std::chrono::milliseconds(rx_timeout);
    *handle = static_cast<NTCAN_HANDLE>(i) + 1;
    return NTCAN_SUCCESS;
  }
  return NTCAN_INSUFFICIENT_RESOURCES;
}

NTCAN_RESULT canClose(NTCAN_HANDLE handle) {
  if (!find(handle)) return NTCAN_INVALID_HANDLE;
  const std::lock_guard lock(table_lock);
  table[static_cast<std::size_t>(handle) - 1].reset();
  return NTCAN_SUCCESS;
}

// The rate is the bus' own. The library remembers what the program sets, and returns it.
NTCAN_RESULT canSetBaudrate(NTCAN_HANDLE handle, uint32_t baud) {
  const auto opened = find(handle);
  if (!opened) return NTCAN_INVALID_HANDLE;
  opened->baud = baud;
  return NTCAN_SUCCESS;
}

NTCAN_RESULT canGetBaudrate(NTCAN_HANDLE handle, uint32_t* baud) {
  const auto opened = find(handle);
  if (!opened) return NTCAN_INVALID_HANDLE;
  if (!baud) return NTCAN_INVALID_PARAMETER;
  *baud = opened->baud;
  return NTCAN_SUCCESS;
}

NTCAN_RESULT canIdAdd(NTCAN_HANDLE handle, int32_t id) {
  const auto opened = find(handle);
  if (!opened) return NTCAN_INVALID_HANDLE;
  if (id < 0 || id > 0x7FF) return NTCAN_INVALID_PARAMETER;
  if (opened->line->hears(static_cast<uint32_t>(id))) return NTCAN_ID_ALREADY_ENABLED;
  opened->line->hear(static_cast<uint32_t>(id), true);
  return NTCAN_SUCCESS;
}

NTCAN_RESULT canIdDelete(NTCAN_HANDLE handle, int32_t id) {
  const auto opened = find(handle);
  if (!opened) return NTCAN_INVALID_HANDLE;
  if (id < 0 || !opened->line->hears(static_cast<uint32_t>(id))) return NTCAN_ID_NOT_ENABLED;
  opened->line->hear(static_cast<uint32_t>(id), false);
  return NTCAN_SUCCESS;
}

NTCAN_RESULT canRead(NTCAN_HANDLE handle, CMSG* messages, int32_t* count, void*) {
  const auto opened = find(handle);
  if (!opened) return NTCAN_INVALID_HANDLE;
  if (!has_room(messages, count)) return NTCAN_INVALID_PARAMETER;
  if (*count == 0) return NTCAN_SUCCESS;
  // A timeout of 0 waits for ever.
  const auto due = opened->rx_timeout.count() > 0 ? CanLine::Clock::now() + opened->rx_timeout
                                                  : CanLine::Clock::time_point::max();
  return receive(*opened->line, messages, count, due);
}

NTCAN_RESULT canTake(NTCAN_HANDLE handle, CMSG* messages, int32_t* count) {
  const auto opened = find(handle);
  if (!opened) return NTCAN_INVALID_HANDLE;
  if (!has_room(messages, count)) return NTCAN_INVALID_PARAMETER;
  if (*count == 0) return NTCAN_SUCCESS;
  const auto result = receive(*opened->line, messages, count, CanLine::Clock::now());
  return result == NTCAN_RX_TIMEOUT ? NTCAN_SUCCESS : result;
}

NTCAN_RESULT canWrite(NTCAN_HANDLE handle, CMSG* messages, int32_t* count, void*) {
  const auto opened = find(handle);
  if (!opened) return NTCAN_INVALID_HANDLE;
  if (!messages || !count || *count < 1) return NTCAN_INVALID_PARAMETER;
  const int32_t wanted = *count;
  for (*count = 0; *count < wanted; ++*count) {
    const CMSG& message = messages[*count];
    if (message.id < 0 || message.id > 0x7FF || message.len > 8) return NTCAN_INVALID_PARAMETER;
    Frame frame{static_cast<uint32_t>(message.id), message.len, {}};
    for (std::size_t i = 0; i < message.len; ++i) frame.data[i] = message.data[i];
    if (!opened->line->write(frame)) return NTCAN_TX_ERROR;
  }
  return NTCAN_SUCCESS;
}

NTCAN_RESULT canSend(NTCAN_HANDLE handle, CMSG* messages, int32_t* count) {
  return canWrite(handle, messages, count, nullptr);
}
