#!/usr/bin/env python3
"""A client of a stream in 50 lines: of each sample "tick x_mm y_mm z_mm fx_N fy_N fz_N", the burr's tip and
the force on the hand. It needs no library; [stream] is told of in scenes/README.md.

    tools/examples/follow_stream.py & sulcus run scenes/side_cut.toml --pace real --set 'stream={}'
"""
import socket, struct, sys, time

HEADER = struct.Struct(">H12s20sQQQ")  # version, type, device, time stamp, size and CRC of the body

CRC = list(range(256))  # ECMA-182
for byte in CRC:
    value = byte << 56
    for _ in range(8):
        value = (value << 1 ^ (0x42F0E1EBA9EA3693 if value >> 63 else 0)) & (1 << 64) - 1
    CRC[byte] = value

def read(size):
    data = b""
    while len(data) < size:
        part = stream.recv(size - len(data))
        if not part:
            sys.exit()  # the run is over
        data += part
    return data

for _ in range(600):  # till there is one
    try:
        stream = socket.create_connection(("127.0.0.1", int((sys.argv + [18944])[1])))
        break
    except ConnectionRefusedError:
        time.sleep(0.1)
tick = position = None
while True:
    _, kind, device, stamp, size, crc = HEADER.unpack(read(HEADER.size))
    body, check = read(size), 0
    for byte in body:
        check = CRC[check >> 56 ^ byte] ^ check << 8 & (1 << 64) - 1
    assert check == crc, device
    if kind.startswith(b"TRANSFORM") and device.startswith(b"Tool"):
        position = struct.unpack(">12f", body)[9:]  # columns; the last one is the place
    elif kind.startswith(b"SENSOR"):  # how many, status, unit, values
        values = struct.unpack_from(f">{body[0]}d", body, 10)
        if device.startswith(b"Tick"):
            tick = int(values[0])
        elif device.startswith(b"Force"):
            print(tick, *position, *values[:3], flush=True)
