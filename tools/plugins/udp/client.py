#!/usr/bin/env python3
"""A device in 30 lines: a mass in a hand, whose spring goes along a path; it feels Sulcus's force.

    sulcus run scenes/udp_hand.toml --pace real --plugins build/release/plugins & tools/plugins/udp/client.py
"""
import socket, struct, sys, time

POSE, WRENCH = struct.Struct("<4sIQ7dII"), struct.Struct("<4sIQQ6dII")  # see udp_device.c
MASS, STIFFNESS, DAMPING, TICK = 0.1, 500.0, 8.0, 1e-3  # kg, N/m, N s/m, s
UPRIGHT = (0.5**0.5, 0.5**0.5, 0.0, 0.0)  # w x y z: the tool's +y along the world's +z

def hand(t):  # where the hand wants the tip, m: in 1 s into the block from above, in 2 s across it
    return -1e-3 + 1e-3 * min(2.0, max(0.0, t - 1.0)), 0.0, 3.3e-3 - 2.3e-3 * min(1.0, t)

port = int(sys.argv[1]) if len(sys.argv) > 1 else 47800
sock = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
sock.connect(("127.0.0.1", port))
sock.settimeout(0.01)
x, v, number, ticks, largest, give_up = list(hand(0)), [0.0] * 3, 0, 0, 0.0, time.monotonic() + 60
while time.monotonic() < give_up:
    number += 1
    try:
        sock.send(POSE.pack(b"SULP", 1, number, *x, *UPRIGHT, int(ticks >= 4000), 0))  # 1: it is over
        *_, fx, fy, fz, _, _, _, over, _ = WRENCH.unpack(sock.recv(80))
    except (TimeoutError, ConnectionRefusedError):  # not there yet, or a datagram was lost
        time.sleep(0.001)
        continue
    if over:
        break
    give_up, ticks = time.monotonic() + 2, ticks + 1
    largest = max(largest, (fx * fx + fy * fy + fz * fz) ** 0.5)
    for i, (force, wanted) in enumerate(zip((fx, fy, fz), hand(ticks * TICK))):
        v[i] += TICK / MASS * (force + STIFFNESS * (wanted - x[i]) - DAMPING * v[i])
        x[i] += TICK * v[i]
print(f"{ticks} ticks, at most {largest:.2f} N" if ticks else f"nobody at port {port}")
