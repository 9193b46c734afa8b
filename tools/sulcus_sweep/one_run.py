"""One run of a sweep: `one_run.py FOLDER NUMBER`, started by GNU parallel or as a task of a Slurm array, on
any machine that sees the folder, the program and the scene under the same paths. Does nothing where the
run is done. Exit status: that of `sulcus run`."""

import json
import os
import shutil
import signal
import socket
import subprocess
import sys

from sweep_folder import SweepFolder, whole_summary, write_whole


def run(folder, number):
    if folder.summary(number) is not None:
        return 0
    asked = folder.asked()
    names, rows = folder.plan()
    part = folder.part_folder(number)
    shutil.rmtree(part, ignore_errors=True)
    part.mkdir()
    command = [asked["program"], "run", asked["scene"], "-o", str(part), "--no-render", *asked["options"]]
    for name, value in zip(names, rows[number]):
        command += ["--set", f"{name}={value}"]
    with open(part / "error.txt", "wb") as errors:
        child = subprocess.Popen(command, cwd=asked["started_in"], stdin=subprocess.DEVNULL,
                                 stdout=subprocess.DEVNULL, stderr=errors)
        # Told to stop, the program ends cleanly, and what it wrote until then is no result.
        stops = []
        for told in (signal.SIGINT, signal.SIGTERM):
            signal.signal(told, lambda *_: (stops.append(1), child.terminate()))
        status = child.wait()
    if stops:
        shutil.rmtree(part)
        return 130
    if status < 0:
        status = 128 - status  # as a shell tells of a signal
    if status == 0 and whole_summary(part) is None:
        status = 1
        with open(part / "error.txt", "a", encoding="utf-8") as errors:
            errors.write("sulcus run ended with status 0, but left no whole summary.json\n")
    attempts = folder.outcome(number).get("attempts", 0) + 1
    ended = {"exit_status": status, "attempts": attempts, "host": socket.gethostname()}
    write_whole(part / "run.json", (json.dumps(ended) + "\n").encode())
    keep(folder, number, part, status)
    return status


def keep(folder, number, part, status):
    """Gives the folder the name of what it holds. Where the same run was at work twice, as after a kill
    that left it alone, the first one stands: the bits are the same."""
    failed = folder.failed_folder(number)
    if folder.summary(number) is not None:
        shutil.rmtree(part)
        return
    shutil.rmtree(failed, ignore_errors=True)
    if status != 0:
        os.rename(part, failed)
        return
    (part / "error.txt").unlink()
    done = folder.run_folder(number)
    shutil.rmtree(done, ignore_errors=True)  # without a whole summary
    os.rename(part, done)


if __name__ == "__main__":
    sys.exit(run(SweepFolder(sys.argv[1]), int(sys.argv[2])))
