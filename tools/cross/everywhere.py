"""Runs golden scenes on every system that was built and prints what came out. tools/everywhere builds."""

import argparse
import csv
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
GOLDEN = ROOT / "tests" / "golden"
RELEASE = ROOT / "build" / "release"
SETS = {"plain": [], "avx2": ["avx2"],
        "avx512": ["avx512f", "avx512bw", "avx512dq", "avx512vl", "avx512vbmi", "avx512_vbmi2",
                   "avx512_vnni"]}
# What an emulator runs in a minute or less each.
QUICK = ["cut_bodies", "cut_full", "cut_loose", "press_bodies", "press_device", "press_hand",
         "probe_ldm", "probe_ldm_anew", "probe_ldm_fast", "probe_ldm_paper"]
RUN_PYTHON = """
import sys, sulcus
s = sulcus.Simulation(sys.argv[1])
s.run()
print(s.volume_hash, s.force_hash)
"""


class Failed(Exception):
    """A system could not run a scene."""


def output_of(command, **variables):
    done = subprocess.run(command, capture_output=True, text=True, cwd=ROOT,
                          env={**os.environ, "SULCUS_CACHE": "off", **variables}, check=False)
    if done.returncode:
        lines = (done.stderr.strip() or "no message").splitlines()
        raise Failed(f"status {done.returncode}: {lines[-1]}")
    return done.stdout


def by_program(scene, instructions):
    with tempfile.TemporaryDirectory() as folder:
        output_of([RELEASE / "sulcus", "run", GOLDEN / f"{scene}.toml", "--no-render", "-o",
                   f"{folder}/out"], SULCUS_INSTRUCTIONS=instructions)
        summary = json.loads(pathlib.Path(folder, "out", "summary.json").read_text())
    return summary["volume_hash"], summary["force_hash"]


def by_c(scene, instructions):
    line = output_of([RELEASE / "sulcus_hashes", f"tests/golden/{scene}.toml"],
                     SULCUS_INSTRUCTIONS=instructions)
    return line.strip().split(",")[1:]


def by_python(scene, instructions):
    return output_of(["/usr/bin/python3", "-c", RUN_PYTHON, GOLDEN / f"{scene}.toml"],
                     SULCUS_INSTRUCTIONS=instructions, PYTHONPATH=str(RELEASE / "python")).split()


def by_wine(scene, instructions):
    line = output_of([wine(), ROOT / "build/windows/sulcus_hashes.exe",
                      f"tests/golden/{scene}.toml"], SULCUS_INSTRUCTIONS=instructions,
                     WINEDEBUG="-all", WINEPREFIX=str(ROOT / "build/windows/wine"))
    return line.strip().split(",")[1:]


def by_qemu(scene, _):
    line = output_of(["qemu-aarch64", "-L", "/usr/aarch64-linux-gnu",
                      ROOT / "build/aarch64/sulcus_hashes", f"tests/golden/{scene}.toml"],
                     LD_LIBRARY_PATH=str(ROOT / "build/aarch64"))
    return line.strip().split(",")[1:]


def wine():
    return shutil.which("wine64") or shutil.which("wine") or "/usr/lib/wine/wine64"


def systems():
    """Name, how it runs a scene, instruction set, whether it is emulated, why not (or None)."""
    flags = set()
    for line in pathlib.Path("/proc/cpuinfo").read_text().splitlines():
        if line.startswith("flags"):
            flags = set(line.split())
            break
    found = []
    for name, needed in SETS.items():
        lacking = [flag for flag in needed if flag not in flags]
        why_not = f"this processor has no {lacking[0]}" if lacking else None
        for way, run in (("program", by_program), ("c", by_c), ("python", by_python)):
            found.append((f"x86_64-{name}-{way}", run, name, False, why_not))
    built = ROOT / "build/windows/sulcus_hashes.exe"
    for name in ("plain", "avx2"):
        lacking = [flag for flag in SETS[name] if flag not in flags]
        why_not = (None if built.exists() else "not built: see build/windows.log")
        found.append((f"windows-{name}-c", by_wine, name, True,
                      f"this processor has no {lacking[0]}" if lacking else why_not))
    built = ROOT / "build/aarch64/sulcus_hashes"
    found.append(("aarch64-c", by_qemu, "plain", True,
                  None if built.exists() else "not built: see build/aarch64.log"))
    return found


def main():
    parser = argparse.ArgumentParser(prog="tools/everywhere")
    parser.add_argument("--scenes", help="of tests/golden, by comma (all; of emulators the quick)")
    parser.add_argument("--systems", help="by comma; the beginning of a name is enough (all)")
    parser.add_argument("-o", help="the table also into a file")
    options = parser.parse_args()
    every = sorted(path.stem for path in GOLDEN.glob("*.toml"))
    wanted = options.scenes.split(",") if options.scenes else None
    for name in wanted or []:
        if name not in every:
            parser.error(f"--scenes: found {name}, expected of {', '.join(every)}")
    asked = tuple(options.systems.split(",")) if options.systems else ("",)

    files = [sys.stdout] + ([open(options.o, "w", encoding="utf-8")] if options.o else [])
    equal = True

    def say(*row):
        for file in files:
            csv.writer(file, lineterminator="\n").writerow(row)
            file.flush()

    say("system", "scene", "volume_hash", "force_hash", "equal")
    for name, run, instructions, emulated, why_not in systems():
        if not name.startswith(asked):
            continue
        for scene in wanted or every:
            if why_not:
                say(name, scene, "", "", f"skipped: {why_not}")
                continue
            if emulated and not wanted and scene not in QUICK:
                say(name, scene, "", "", "skipped: minutes under an emulator (--scenes runs it)")
                continue
            golden = json.loads((GOLDEN / f"{scene}.json").read_text())
            try:
                volume, force = run(scene, instructions)
            except Failed as why:
                equal = False
                say(name, scene, "", "", f"failed: {why}")
                continue
            same = (volume, force) == (golden["volume_hash"], golden["force_hash"])
            equal &= same
            say(name, scene, volume, force, "yes" if same else "no")
    return 0 if equal else 1


if __name__ == "__main__":
    sys.exit(main())
