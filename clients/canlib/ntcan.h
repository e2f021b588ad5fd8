/* The functions of esd's libntcan that programs for PowerCube modules call. Such a program can be linked, or
 * run, with Visum's replacement. Only types, numbers and names are the vendor's. All calls return
 * NTCAN_SUCCESS or an error. A handle may be used by two threads at once, one that reads and one that writes.
 */
#pragma once

#include <errno.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define NTCAN_SUCCESS 0
#define NTCAN_RX_TIMEOUT 0x101
#define NTCAN_TX_ERROR 0x104
#define NTCAN_CONTR_OFF_BUS 0x105 /* the bus is gone */
#define NTCAN_ID_NOT_ENABLED 0x10B
#define NTCAN_ID_ALREADY_ENABLED 0x10A
#define NTCAN_INVALID_PARAMETER EINVAL
#define NTCAN_INVALID_HANDLE EBADFD
#define NTCAN_NET_NOT_FOUND ENODEV
#define NTCAN_INSUFFICIENT_RESOURCES ENOMEM

#define NTCAN_BAUD_1000 0x0
#define NTCAN_BAUD_500 0x2
#define NTCAN_BAUD_250 0x4
#define NTCAN_BAUD_125 0x6

typedef int32_t NTCAN_RESULT;
typedef int32_t NTCAN_HANDLE;

#pragma pack(push, 1)
typedef struct {
  int32_t id;
  uint8_t len; /* 0 to 8 */
  uint8_t msg_lost;
  uint8_t reserved[2];
  uint8_t data[8];
} CMSG;
#pragma pack(pop)

/* Times in ms. The net's number does not matter: there is one bus, which VISUM_CAN names. */
NTCAN_RESULT canOpen(int32_t net, uint32_t flags, int32_t tx_queue, int32_t rx_queue, int32_t tx_timeout,
                     int32_t rx_timeout, NTCAN_HANDLE* handle);
NTCAN_RESULT canClose(NTCAN_HANDLE handle);
NTCAN_RESULT canSetBaudrate(NTCAN_HANDLE handle, uint32_t baud);
NTCAN_RESULT canGetBaudrate(NTCAN_HANDLE handle, uint32_t* baud);
NTCAN_RESULT canIdAdd(NTCAN_HANDLE handle, int32_t id);
NTCAN_RESULT canIdDelete(NTCAN_HANDLE handle, int32_t id);
/* `count`: room for so many, then how many there were. canRead waits for the first, canTake does not. With a
 * count of 0 both succeed at once with no messages. */
NTCAN_RESULT canRead(NTCAN_HANDLE handle, CMSG* messages, int32_t* count, void* overlapped);
NTCAN_RESULT canTake(NTCAN_HANDLE handle, CMSG* messages, int32_t* count);
NTCAN_RESULT canWrite(NTCAN_HANDLE handle, CMSG* messages, int32_t* count, void* overlapped);
NTCAN_RESULT canSend(NTCAN_HANDLE handle, CMSG* messages, int32_t* count);

#ifdef __cplusplus
}
#endif
