"""Moves module 1 of an arm in steps with pyserial, and sleeps between them: serial_steps.py DEVICE STEPS, where DEVICE may be
socket://HOST:PORT."""
import struct
import sys
import time

import serial

STX, ETX, DLE = 0x02, 0x03, 0x10


def frame(module, data):
    """As libm5api makes it."""
    header = [0x04 | module >> 3, (module & 7) << 5 | len(data)]
    total = sum(header) + sum(data)
    escaped = bytearray()
    for byte in [*header, *data, (total + (total >> 8)) & 0xFF]:
        escaped += bytes([DLE, byte + 0x80]) if byte in (STX, ETX, DLE) else bytes([byte])
    return bytes([STX]) + bytes(escaped) + bytes([ETX])


def ask(line, module, data):
    line.reset_input_buffer()
    line.write(frame(module, data))
    answer = line.read_until(bytes([ETX]))
    assert answer.endswith(bytes([ETX])), f"no answer: {answer!r}"
    return answer


def main():
    with serial.serial_for_url(sys.argv[1], 38400, timeout=0.5) as line:
        begin = time.monotonic()
        ask(line, 1, [0x00])
        answers = b""
        for k in range(1, int(sys.argv[2]) + 1):
            answers += ask(line, 1, [0x0B, 0x10, *struct.pack("<fH", 0.002 * k, 22)])
            time.sleep(0.02)
        print(answers.hex(), f"{time.monotonic() - begin:.6f} s", time.strftime("%Y-%m-%d", time.gmtime()))


if __name__ == "__main__":
    main()
