"""Hands runs to GNU parallel or to Slurm, and waits for them. What they made of them is on disk."""

import pathlib
import re
import shlex
import shutil
import signal
import subprocess
import sys
import time

from errors import InputError, SweepError

ATTEMPTS = 3  # of a run that fails
_ONE_RUN = pathlib.Path(__file__).with_name("one_run.py")
_POLL_S = 2.0  # how often Slurm is asked


def need(program, package):
    if shutil.which(program) is None:
        raise InputError(f"{program}: not installed, expected Debian's {package}")


def _one_run(folder):
    return f"{shlex.quote(sys.executable)} -B {shlex.quote(str(_ONE_RUN))} {shlex.quote(str(folder.path))}"


def _for_parallel(command):
    """GNU parallel replaces what stands in braces, and runs some of it as Perl, in quotes too: the shell
    makes the braces of a command that shlex has quoted."""
    return command.replace("{", "'\"$(printf '\\173')\"'")


def through_parallel(folder, numbers, jobs, machines):
    """Runs the numbers by GNU parallel, as many at once as there are cores, or `jobs`, on this machine or
    those of the file `machines`. joblog.tsv has a line of each."""
    command = ["parallel", "--will-cite", "--joblog", f"+{folder.path / 'joblog.tsv'}",
               "--retries", str(ATTEMPTS)]
    if jobs is not None:
        command += ["-j", str(jobs)]
    if machines is not None:
        command += ["--sshloginfile", machines]
    if sys.stderr.isatty():
        command += ["--bar"]
    given = "".join(f"{number}\n" for number in numbers)
    parallel = subprocess.Popen([*command, _for_parallel(_one_run(folder)) + " {}"], stdin=subprocess.PIPE)
    try:
        parallel.communicate(given.encode())
    except KeyboardInterrupt:
        parallel.send_signal(signal.SIGINT)
        parallel.wait()
        raise
    if parallel.returncode == 255:  # below: how many runs failed
        raise SweepError("GNU parallel could not go on; what it said is above")


def through_slurm(folder, unfinished):
    """Runs what `unfinished()` says, as arrays, and again what of it has failed. Arrays of an earlier call
    that are still there are waited for first."""
    waited = folder.path / "slurm_jobs"
    if waited.exists():
        _wait_for(waited.read_text().split())
        waited.unlink()
    for _ in range(ATTEMPTS):
        numbers = unfinished()
        if not numbers:
            return
        jobs = []
        for first, array in _arrays(numbers, _array_limit()):
            # A task is told its number within its array, which is limited.
            task = f"exec {_one_run(folder)} $(({first} + SLURM_ARRAY_TASK_ID))"
            jobs.append(_ask(["sbatch", "--parsable", f"--array={array}", f"--job-name={folder.path.name}",
                              f"--output={folder.path / 'slurm.txt'}", "--open-mode=append",
                              f"--chdir={folder.path}", f"--wrap={task}"]).split(";")[0].strip())
            waited.write_text("\n".join(jobs) + "\n")
        _wait_for(jobs)
        waited.unlink()


def _ask(command):
    """What a command of Slurm answers; SweepError."""
    ended = subprocess.run(command, capture_output=True, text=True, check=False)
    if ended.returncode != 0:
        raise SweepError(f"{command[0]}: {' '.join(ended.stderr.split()) or ended.returncode}")
    return ended.stdout


def _array_limit():
    """How many tasks an array may have."""
    found = re.search(r"MaxArraySize\s*=\s*(\d+)", _ask(["scontrol", "show", "config"]))
    return int(found[1]) if found else 1001


def _arrays(numbers, limit):
    """(number of task 0, list of tasks as sbatch takes it) of one array after another"""
    for first in range(0, max(numbers) + 1, limit):
        tasks = [number - first for number in numbers if first <= number < first + limit]
        if tasks:
            yield first, ",".join(_spans(tasks))


def _spans(tasks):
    """3, 5, 6, 7 as "3", "5-7"."""
    start = last = tasks[0]
    for task in [*tasks[1:], None]:
        if task is not None and task == last + 1:
            last = task
            continue
        yield str(start) if start == last else f"{start}-{last}"
        start = last = task


def _wait_for(jobs):
    """Until none of the jobs is waiting or running. A controller that does not answer is asked again."""
    said = False
    while jobs:
        ended = subprocess.run(["squeue", "--noheader", "--format=%i", f"--jobs={','.join(jobs)}"],
                               capture_output=True, text=True, check=False)
        if ended.returncode == 0 and not ended.stdout.strip():
            return
        if ended.returncode == 0:
            said = False
        elif "Invalid job id" in ended.stderr:
            return  # forgotten, as it does with what ended some minutes ago
        elif not said:
            said = True
            print(f"sweep: waiting for Slurm: {' '.join(ended.stderr.split())}", file=sys.stderr)
        time.sleep(_POLL_S)
