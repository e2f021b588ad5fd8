/* A program for modules on esd's CAN: as m5api does it, with a handle for the device and one for
 * synchronisation. Prints what it finds; exits 0 if all went as it should. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "clients/canlib/ntcan.h"

#define EXPECT(condition)                                     \
  do {                                                        \
    if (!(condition)) {                                       \
      fprintf(stderr, "line %d: " #condition "\n", __LINE__); \
      return 1;                                               \
    }                                                         \
  } while (0)

static int put(NTCAN_HANDLE handle, int32_t id, const void* data, uint8_t size) {
  CMSG message;
  int32_t count = 1;
  memset(&message, 0, sizeof message);
  message.id = id;
  message.len = size;
  memcpy(message.data, data, size);
  return canWrite(handle, &message, &count, NULL) == NTCAN_SUCCESS && count == 1;
}

static int answer(NTCAN_HANDLE handle, CMSG* message) {
  int32_t count = 1;
  return canRead(handle, message, &count, NULL) == NTCAN_SUCCESS && count == 1;
}

/* Three handles, of which one is read: as many requests as are asked for, each answered at once. */
static int many(long requests) {
  NTCAN_HANDLE handles[3];
  CMSG message;
  int32_t id, count = 0;
  for (int i = 0; i < 3; ++i) {
    EXPECT(canOpen(0, 0, 50, 50, 100, 5000, &handles[i]) == NTCAN_SUCCESS);
    for (id = 1; id < 32; ++id) EXPECT(canIdAdd(handles[i], 0x0A0 + id) == NTCAN_SUCCESS);
  }
  for (long k = 0; k < requests; ++k) {
    id = (int32_t)(1 + k % 8);
    EXPECT(put(handles[0], 0x0C0 + id, "\x0A\x1D", 2));
    EXPECT(answer(handles[0], &message));
    EXPECT(message.id == 0x0A0 + id && message.msg_lost == 0);
  }
  /* The handle that was not read holds whole frames, as many as its queue has room for. */
  do {
    count = 1;
    EXPECT(canTake(handles[2], &message, &count) == NTCAN_SUCCESS);
    EXPECT(count == 0 || (message.id > 0x0A0 && message.id < 0x0C0 && message.len == 4));
  } while (count > 0);
  puts("all answered");
  return 0;
}

int main(int argc, char** argv) {
  NTCAN_HANDLE device = -1, sync = -1;
  CMSG message;
  int32_t count = 1, id;
  int modules = 0;
  float target = 0.2F, position;
  unsigned char ramp[6] = {0x0B, 0x0E};
  uint32_t baud = 0;

  if (argc > 1) return many(atol(argv[1]));
  EXPECT(canOpen(0, 0, 50, 50, 100, 200, &device) == NTCAN_SUCCESS);
  EXPECT(canOpen(0, 0, 50, 50, 100, 200, &sync) == NTCAN_SUCCESS);
  EXPECT(canSetBaudrate(device, NTCAN_BAUD_500) == NTCAN_SUCCESS);
  EXPECT(canGetBaudrate(device, &baud) == NTCAN_SUCCESS && baud == NTCAN_BAUD_500);
  for (id = 1; id < 32; ++id) EXPECT(canIdAdd(device, 0x0A0 + id) == NTCAN_SUCCESS);
  EXPECT(canIdAdd(device, 0x0A1) == NTCAN_ID_ALREADY_ENABLED);
  EXPECT(canIdAdd(sync, 0x100) == NTCAN_SUCCESS);

  for (id = 1; id <= 8; ++id) {
    EXPECT(put(device, 0x0C0 + id, "\x0A\x1D", 2));
    EXPECT(answer(device, &message));
    EXPECT(message.id == 0x0A0 + id && message.len == 4 && message.data[1] == 0x1D);
    ++modules;
  }
  printf("%d modules\n", modules);

  EXPECT(put(device, 0x0C9, "\x0A\x1D", 2)); /* nobody */
  count = 1;
  EXPECT(canRead(device, &message, &count, NULL) == NTCAN_RX_TIMEOUT);
  count = 1;
  EXPECT(canTake(device, &message, &count) == NTCAN_SUCCESS && count == 0);
  /* As programs do: with the count of the last call. */
  EXPECT(canTake(device, &message, &count) == NTCAN_SUCCESS && count == 0);
  EXPECT(canRead(device, &message, &count, NULL) == NTCAN_SUCCESS && count == 0);
  count = -1;
  EXPECT(canTake(device, &message, &count) == NTCAN_INVALID_PARAMETER);

  memcpy(ramp + 2, &target, 4);
  EXPECT(put(device, 0x0E1, ramp, 6));
  EXPECT(answer(device, &message) && message.len == 8);
  do {
    EXPECT(put(device, 0x0C1, "\x0A\x3C", 2));
    EXPECT(answer(device, &message) && message.data[1] == 0x3C);
    memcpy(&position, message.data + 2, 4);
  } while (position < 0.19F);
  printf("module 1 came to 0.19\n");

  /* A broadcast of one handle is heard by the other, and no answer is. */
  EXPECT(put(device, 0x100, "\x0F", 1));
  EXPECT(answer(sync, &message) && message.id == 0x100 && message.data[0] == 0x0F);
  count = 1;
  EXPECT(canTake(sync, &message, &count) == NTCAN_SUCCESS && count == 0);

  EXPECT(canClose(sync) == NTCAN_SUCCESS);
  EXPECT(canClose(device) == NTCAN_SUCCESS);
  EXPECT(canClose(device) == NTCAN_INVALID_HANDLE);
  EXPECT(canRead(device, &message, &count, NULL) == NTCAN_INVALID_HANDLE);
  printf("all well\n");
  return 0;
}
