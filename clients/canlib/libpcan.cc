// The part of PEAK's libpcan that programs for PowerCube modules use, over a bus of Visum's.
#include "clients/canlib/libpcan.h"

#include <cerrno>
#include <cstdio>

#include "clients/canlib/can_line.h"

namespace {

using visum::canlib::CanLine;
using visum::canlib::Frame;

struct Opened {
  std::unique_ptr<CanLine> line;
  bool filtered = false;  // CAN_MsgFilter was called: only its ids are received
  DWORD reads = 0, writes = 0;
};

thread_local int last_error = 0;

Opened* from(HANDLE handle) {
  return static_cast<Opened*>(handle);
}

DWORD receive(Opened& opened, TPCANRdMsg* message, CanLine::Clock::time_point due) {
  const auto frame = opened.line->read(due);
  if (!frame) return opened.line->gone() ? CAN_ERR_BUSOFF : CAN_ERR_QRCVEMPTY;
  ++opened.reads;
  *message = {};
  message->Msg.ID = frame->id;
  message->Msg.LEN = frame->size;
  for (std::size_t i = 0; i < frame->size; ++i) message->Msg.DATA[i] = frame->data[i];
  const auto now = CanLine::Clock::now().time_since_epoch();
  const auto us = std::chrono::duration_cast<std::chrono::microseconds>(now).count();
  message->dwTime = static_cast<DWORD>(us / 1000);
  message->wUsec = static_cast<WORD>(us % 1000);
  return CAN_ERR_OK;
}

}  // namespace

HANDLE LINUX_CAN_Open(const char*, int) {
  auto line = CanLine::open("libpcan (Visum)");
  last_error = line ? 0 : ENODEV;
  if (!line) return nullptr;
  line->hear_all();
  auto* opened = new Opened;
  opened->line = std::move(line);
  return opened;
}

// The rate is the bus' own and cannot be set here.
DWORD CAN_Init(HANDLE handle, WORD, int) {
  return handle ? CAN_ERR_OK : CAN_ERRMASK_ILLHANDLE;
}

DWORD CAN_Close(HANDLE handle) {
  if (!handle) return CAN_ERRMASK_ILLHANDLE;
  delete from(handle);
  return CAN_ERR_OK;
}

DWORD CAN_Status(HANDLE handle) {
  if (!handle) return CAN_ERRMASK_ILLHANDLE;
  auto& line = *from(handle)->line;
  if (line.waiting()) return CAN_ERR_OK;
  return line.gone() ? CAN_ERR_BUSOFF : CAN_ERR_QRCVEMPTY;
}

DWORD CAN_Write(HANDLE handle, TPCANMsg* message) {
  if (!handle) return CAN_ERRMASK_ILLHANDLE;
  if (!message || message->MSGTYPE != MSGTYPE_STANDARD || message->ID > 0x7FF || message->LEN > 8)
    return CAN_ERR_ILLPARAMVAL;
  Frame frame{message->ID, message->LEN, {}};
  for (std::size_t i = 0; i < message->LEN; ++i) frame.data[i] = message->DATA[i];
  if (!from(handle)->line->write(frame)) return CAN_ERR_BUSOFF;
  ++from(handle)->writes;
  return CAN_ERR_OK;
}

DWORD LINUX_CAN_Read_Timeout(HANDLE handle, TPCANRdMsg* message, int wait_us) {
  if (!handle) return CAN_ERRMASK_ILLHANDLE;
  if (!message) return CAN_ERR_ILLPARAMVAL;
  const auto due = wait_us < 0 ? CanLine::Clock::time_point::max()
                               : CanLine::Clock::now() + std::chrono::microseconds(wait_us);
  return receive(*from(handle), message, due);
}

DWORD LINUX_CAN_Read(HANDLE handle, TPCANRdMsg* message) {
  return LINUX_CAN_Read_Timeout(handle, message, -1);
}

DWORD CAN_Read(HANDLE handle, TPCANMsg* message) {
  if (!message) return handle ? CAN_ERR_ILLPARAMVAL : CAN_ERRMASK_ILLHANDLE;
  TPCANRdMsg whole{};
  const DWORD result = LINUX_CAN_Read(handle, &whole);
  *message = whole.Msg;
  return result;
}

DWORD CAN_ResetFilter(HANDLE handle) {
  if (!handle) return CAN_ERRMASK_ILLHANDLE;
  from(handle)->filtered = false;
  from(handle)->line->hear_all();
  return CAN_ERR_OK;
}

// The first filter shuts out all other ids; each further one lets more in.
DWORD CAN_MsgFilter(HANDLE handle, DWORD from_id, DWORD to_id, int message_type) {
  if (!handle) return CAN_ERRMASK_ILLHANDLE;
  if (message_type != MSGTYPE_STANDARD || from_id > to_id || to_id > 0x7FF) return CAN_ERR_ILLPARAMVAL;
  auto& opened = *from(handle);
  for (DWORD id = 0; id <= 0x7FF; ++id) {
    const bool inside = id >= from_id && id <= to_id;
    if (inside || !opened.filtered) opened.line->hear(id, inside);
  }
  opened.filtered = true;
  return CAN_ERR_OK;
}

DWORD LINUX_CAN_Statistics(HANDLE handle, TPDIAG* statistics) {
  if (!handle) return CAN_ERRMASK_ILLHANDLE;
  if (!statistics) return CAN_ERR_ILLPARAMVAL;
  *statistics = {};
  statistics->dwReadCounter = from(handle)->reads;
  statistics->dwWriteCounter = from(handle)->writes;
  statistics->nOpenPaths = 1;
  std::snprintf(statistics->szVersionString, sizeof statistics->szVersionString, "Visum");
  return CAN_ERR_OK;
}

int LINUX_CAN_FileHandle(HANDLE handle) {
  return handle ? from(handle)->line->descriptor() : -1;
}

int nGetLastError(void) {
  return last_error;
}
