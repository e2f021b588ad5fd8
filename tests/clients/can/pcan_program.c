/* The same for PEAK's library. */
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "clients/canlib/libpcan.h"

#define EXPECT(condition)                                     \
  do {                                                        \
    if (!(condition)) {                                       \
      fprintf(stderr, "line %d: " #condition "\n", __LINE__); \
      return 1;                                               \
    }                                                         \
  } while (0)

static int put(HANDLE handle, DWORD id, const void* data, BYTE size) {
  TPCANMsg message;
  memset(&message, 0, sizeof message);
  message.ID = id;
  message.LEN = size;
  memcpy(message.DATA, data, size);
  return CAN_Write(handle, &message) == CAN_ERR_OK;
}

/* Three handles, of which one is read: as many requests as are asked for, each answered at once. */
static int many(long requests) {
  HANDLE handles[3];
  TPCANRdMsg message;
  DWORD result;
  for (int i = 0; i < 3; ++i) {
    handles[i] = LINUX_CAN_Open("/dev/pcan32", O_RDWR);
    EXPECT(handles[i] != NULL);
    EXPECT(CAN_MsgFilter(handles[i], 0x0A1, 0x0BF, MSGTYPE_STANDARD) == CAN_ERR_OK);
  }
  for (long k = 0; k < requests; ++k) {
    const DWORD id = (DWORD)(1 + k % 8);
    EXPECT(put(handles[0], 0x0C0 + id, "\x0A\x20", 2));
    EXPECT(LINUX_CAN_Read_Timeout(handles[0], &message, 5000000) == CAN_ERR_OK);
    EXPECT(message.Msg.ID == 0x0A0 + id && message.Msg.DATA[2] == id);
  }
  /* The handle that was not read holds whole frames, as many as its queue has room for. */
  while ((result = LINUX_CAN_Read_Timeout(handles[2], &message, 0)) == CAN_ERR_OK)
    EXPECT(message.Msg.ID > 0x0A0 && message.Msg.ID < 0x0C0 && message.Msg.LEN == 3);
  EXPECT(result == CAN_ERR_QRCVEMPTY);
  puts("all answered");
  return 0;
}

int main(int argc, char** argv) {
  TPCANRdMsg message;
  TPDIAG statistics;
  DWORD id;
  if (argc > 1) return many(atol(argv[1]));
  HANDLE handle = LINUX_CAN_Open("/dev/pcan32", O_RDWR);

  EXPECT(handle != NULL);
  EXPECT(CAN_Init(handle, CAN_BAUD_500K, CAN_INIT_TYPE_ST) == CAN_ERR_OK);
  EXPECT(CAN_MsgFilter(handle, 0x0A1, 0x0A4, MSGTYPE_STANDARD) == CAN_ERR_OK);
  EXPECT(CAN_MsgFilter(handle, 0x0A5, 0x0BF, MSGTYPE_STANDARD) == CAN_ERR_OK);
  EXPECT(CAN_Status(handle) == CAN_ERR_QRCVEMPTY);
  for (id = 1; id <= 8; ++id) {
    EXPECT(put(handle, 0x0C0 + id, "\x0A\x20", 2));
    EXPECT(LINUX_CAN_Read_Timeout(handle, &message, 200000) == CAN_ERR_OK);
    EXPECT(message.Msg.ID == 0x0A0 + id && message.Msg.LEN == 3 && message.Msg.DATA[2] == id);
  }
  EXPECT(put(handle, 0x0C9, "\x0A\x20", 2)); /* nobody */
  EXPECT(LINUX_CAN_Read_Timeout(handle, &message, 1000) == CAN_ERR_QRCVEMPTY);
  EXPECT(LINUX_CAN_Statistics(handle, &statistics) == CAN_ERR_OK);
  EXPECT(statistics.dwReadCounter == 8 && statistics.dwWriteCounter == 9);
  EXPECT(CAN_MsgFilter(handle, 0x800, 0x900, MSGTYPE_STANDARD) == CAN_ERR_ILLPARAMVAL);
  EXPECT(CAN_Close(handle) == CAN_ERR_OK);
  EXPECT(CAN_Write(NULL, NULL) == CAN_ERRMASK_ILLHANDLE);
  printf("all well\n");
  return 0;
}
