/* The functions of PEAK's libpcan (the chardev driver's) that programs for PowerCube modules call. Such a
 * program can be linked, or run, with Visum's replacement. Only types, numbers and names are the vendor's. */
#pragma once

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef void* HANDLE;
typedef uint32_t DWORD;
typedef uint16_t WORD;
typedef uint8_t BYTE;

#define CAN_ERR_OK 0x0000
#define CAN_ERR_BUSOFF 0x0010
#define CAN_ERR_QRCVEMPTY 0x0020
#define CAN_ERR_QXMTFULL 0x0080
#define CAN_ERRMASK_ILLHANDLE 0x1C00
#define CAN_ERR_ILLPARAMVAL 0x8000

#define CAN_BAUD_1M 0x0014
#define CAN_BAUD_500K 0x001C
#define CAN_BAUD_250K 0x011C
#define CAN_BAUD_125K 0x031C
#define CAN_INIT_TYPE_ST 0x00
#define MSGTYPE_STANDARD 0x00
#define MSGTYPE_RTR 0x01
#define MSGTYPE_EXTENDED 0x02

typedef struct {
  DWORD ID;
  BYTE MSGTYPE;
  BYTE LEN;
  BYTE DATA[8];
} TPCANMsg;

typedef struct {
  TPCANMsg Msg;
  DWORD dwTime; /* ms */
  WORD wUsec;
} TPCANRdMsg;

typedef struct {
  WORD wType;
  DWORD dwBase;
  WORD wIrqLevel;
  DWORD dwReadCounter;
  DWORD dwWriteCounter;
  DWORD dwIRQcounter;
  DWORD dwErrorCounter;
  WORD wErrorFlag;
  int nLastError;
  int nOpenPaths;
  char szVersionString[64];
} TPDIAG;

/* The device's name does not matter: there is one bus, which VISUM_CAN names. */
HANDLE LINUX_CAN_Open(const char* device, int flags);
DWORD CAN_Init(HANDLE handle, WORD btr0btr1, int message_type);
DWORD CAN_Close(HANDLE handle);
DWORD CAN_Status(HANDLE handle); /* CAN_ERR_QRCVEMPTY: nothing has come */
DWORD CAN_Write(HANDLE handle, TPCANMsg* message);
DWORD CAN_Read(HANDLE handle, TPCANMsg* message);
DWORD LINUX_CAN_Read(HANDLE handle, TPCANRdMsg* message);
/* Waits for so many µs; 0: not at all; below 0: for ever. */
DWORD LINUX_CAN_Read_Timeout(HANDLE handle, TPCANRdMsg* message, int wait_us);
DWORD CAN_ResetFilter(HANDLE handle);
DWORD CAN_MsgFilter(HANDLE handle, DWORD from_id, DWORD to_id, int message_type);
DWORD LINUX_CAN_Statistics(HANDLE handle, TPDIAG* statistics);
int LINUX_CAN_FileHandle(HANDLE handle);
int nGetLastError(void);

#ifdef __cplusplus
}
#endif
