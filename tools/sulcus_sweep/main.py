"""tools/sweep: runs a scene with many values of its keys, and makes one table of what came of it."""

import argparse
import collections
import fcntl
import pathlib
import signal
import subprocess
import sys

from chart import draw_chart
from errors import InputError, SweepError, one_line
from input_files import hash_of, hashes_of_named
from launch import need, through_parallel, through_slurm
from plan import all_combinations, latin_hypercube, parse_sets
from sweep_folder import SweepFolder
from table import make_tables, write_tables

_ROOT = pathlib.Path(__file__).resolve().parents[2]
_PROGRAM = _ROOT / "build/release/sulcus"
_MOST_RUNS = 1_000_000

_HELP = """
values: KEY=VALUE,VALUE,... as sulcus run --set takes them; commas within brackets or quotes part nothing:
  --set 'workpiece.cells=[64, 64, 64],[128, 128, 128]'. With --latin also KEY=LOW:HIGH, whole numbers
  where both ends are (1:6), else any (1.0:6.0).
The same command again, or `tools/sweep -o DIR` alone, goes on where it was stopped, tries again what
failed, and makes tables and charts anew. Ctrl-C stops it; an array goes on in Slurm and is waited for.
In DIR: plan.csv, runs/000000/ ..., table.csv and table.h5 (what does not depend on the machine: a repeated
sweep gives the same bytes), times.csv and times.h5 (what does).
Slurm's own SBATCH_* and GNU parallel's PARALLEL variables hold further options of theirs. All machines
must see DIR, the scene and the program under the same paths.
exit status: 0 all runs are done, 1 some failed, 2 bad usage or input, 130 stopped"""


class _Parser(argparse.ArgumentParser):
    def error(self, message):
        raise InputError(f"{message} (see tools/sweep --help)")


def parse_arguments(arguments):
    parser = _Parser(prog="tools/sweep", epilog=_HELP, allow_abbrev=False,
                     description=__doc__.partition(": ")[2],
                     usage="%(prog)s [SCENE --set KEY=VALUES ...] -o DIR [options] [-- options of run]",
                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene", nargs="?", metavar="SCENE",
                        help="scene file, .toml, or the name of a shipped one")
    parser.add_argument("--set", action="append", default=[], dest="sets", metavar="KEY=VALUES",
                        help="values that a key takes; repeatable")
    parser.add_argument("-o", required=True, dest="folder", metavar="DIR", help="folder of the sweep")
    parser.add_argument("--latin", type=int, metavar="N",
                        help="N runs, a Latin hypercube, instead of every combination")
    parser.add_argument("--seed", type=int, metavar="S", help="of the hypercube (1)")
    parser.add_argument("-j", type=int, dest="jobs", metavar="N",
                        help="runs at once on a machine (its cores)")
    parser.add_argument("--sshloginfile", metavar="FILE", help="machines, as GNU parallel takes them")
    parser.add_argument("--slurm", action="store_true", help="by Slurm, as an array, not by GNU parallel")
    parser.add_argument("--chart", nargs=2, action="append", default=[], metavar=("X", "Y"),
                        help="draw one column against another; repeatable")
    parser.add_argument("--plan-only", action="store_true", help="write plan.csv, run nothing")
    parser.add_argument("--program", default=str(_PROGRAM), metavar="FILE",
                        help="sulcus (the one built here)")
    ours, options = arguments, []
    if "--" in arguments:
        at = arguments.index("--")
        ours, options = arguments[:at], arguments[at + 1:]
    given = parser.parse_args(ours)
    given.options = options
    if not given.folder:
        raise InputError("-o: is empty, expected a folder")
    if given.latin is not None and not 1 <= given.latin <= _MOST_RUNS:
        raise InputError(f"--latin {given.latin}: expected 1 to {_MOST_RUNS} runs")
    if given.seed is not None and given.latin is None:
        raise InputError("--seed: is that of a Latin hypercube, expected --latin N with it")
    if given.slurm and (given.jobs or given.sshloginfile):
        raise InputError("--slurm: has its own machines, expected no -j and no --sshloginfile with it")
    if given.jobs is not None and given.jobs < 1:
        raise InputError(f"-j {given.jobs}: expected at least 1 run at once")
    if given.sshloginfile and not pathlib.Path(given.sshloginfile).is_file():
        raise InputError(f"{given.sshloginfile}: no such file, expected a machine a line")
    return given


def check_scene(asked, keys):
    """Has the program read the scene with each value of each key, the others at their first, before many
    runs are started; InputError with its line."""
    program, scene = asked["program"], asked["scene"]
    # Options are read before the scene, which here is none.
    none = f"{scene}.none"
    refused = _said([program, "run", none, "-o", none, "--no-render", *asked["options"], "--set", "a=1"])
    if none not in refused:
        raise InputError(f"options after --: {refused or 'they run nothing, expected those of sulcus run'}")
    first = {key.name: key.to_check()[0] for key in keys}
    tried = [first] + [first | {key.name: value} for key in keys for value in key.to_check()[1:]]
    for values in tried:
        sets = [word for name, value in values.items() for word in ("--set", f"{name}={value}")]
        if refused := _said([program, "inspect", scene, *sets]):
            raise InputError(refused)


def _said(command):
    """The line with which sulcus refuses a command; "" where it does not."""
    ended = subprocess.run(command, capture_output=True, text=True, errors="replace", check=False)
    if ended.returncode == 0:
        return ""
    lines = ended.stderr.strip().splitlines() or [f"{command[0]} ended with status {ended.returncode}"]
    return lines[-1].removeprefix("sulcus: ")


def scene_file(given):
    """A file, else the shipped scene of that name, as sulcus run takes them; InputError."""
    paths = [pathlib.Path(given)]
    if "/" not in given:
        paths += [_ROOT / "scenes" / given, _ROOT / "scenes" / f"{given}.toml"]
    for path in paths:
        if path.is_file():
            return path
    raise InputError(f"{given}: no such file, expected a scene, .toml, or the name of a shipped one")


def planned(asked):
    """(names of the swept keys, rows of values) of what was asked for."""
    latin = asked["latin"]
    keys = parse_sets(asked["set"], latin is not None)
    rows = all_combinations(keys) if latin is None else latin_hypercube(keys, latin, asked["seed"])
    return [key.name for key in keys], rows


def with_hashes(asked):
    """What was asked for, with the hashes of what its runs read now."""
    scene = scene_file(asked["scene"])
    keys = parse_sets(asked["set"], asked["latin"] is not None)
    return asked | {"scene_sha256": hash_of(scene),
                    "files_sha256": hashes_of_named(scene, keys, asked["options"], asked["started_in"])}


def begin(given):
    """The folder with its plan: what was asked for now, or when it was begun."""
    folder = SweepFolder(given.folder)
    if given.scene is None:
        if given.sets or given.latin is not None or given.options:
            raise InputError("SCENE: is missing, expected a scene file, .toml")
        asked = folder.asked()
        if asked is None:
            raise InputError(f"{folder.path}: holds no sweep to go on with, expected SCENE and --set")
        if given.program not in (str(_PROGRAM), asked["program"]):
            raise InputError(f"--program {given.program}: the sweep has another, expected "
                             f"{asked['program']}")
        folder.begin(asked, *planned(asked))
        return folder
    if not given.sets:
        raise InputError("--set: is missing, expected KEY=VALUE,VALUE,... at least once")
    keys = parse_sets(given.sets, given.latin is not None)
    scene = scene_file(given.scene)
    runs = given.latin
    if runs is None:
        runs = 1
        for key in keys:
            runs *= len(key.values)
        if runs > _MOST_RUNS:
            raise InputError(f"--set: {runs} combinations, expected at most {_MOST_RUNS}")
    if not pathlib.Path(given.program).is_file():
        raise InputError(f"{given.program}: no such file, expected the program sulcus")
    seed = None if given.latin is None else 1 if given.seed is None else given.seed
    asked = {"scene": str(scene.resolve()),
             "set": given.sets, "latin": given.latin, "seed": seed, "options": given.options,
             "program": str(pathlib.Path(given.program).resolve()), "started_in": str(pathlib.Path.cwd())}
    if folder.asked() is None:
        check_scene(asked, keys)
    folder.begin(with_hashes(asked), *planned(asked))
    return folder


def hold(folder):
    """Keeps a second sweep out of the folder until the program ends."""
    lock = open(folder.path / "lock", "w", encoding="utf-8")
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        raise SweepError(f"{folder.path}: another sweep is at work in it") from None
    return lock


def report(folder, names, rows, table):
    """Says what came of it; the exit status."""
    missing = [n for n in range(len(rows)) if folder.summary(n) is None]
    for number in missing:
        values = ", ".join(f"{name}={value}" for name, value in zip(names, rows[number]))
        ended = folder.outcome(number)
        tried = f"status {ended['exit_status']} in {ended['attempts']} attempts" if ended else "no status"
        print(f"run {number:06d} failed ({values}), {tried}: {folder.error(number)}", file=sys.stderr)
    builds = collections.Counter(row["build"] for row in table if "build" in row)
    if len(builds) > 1:
        print(f"sweep: the runs are of {len(builds)} builds: {', '.join(builds)}", file=sys.stderr)
    print(f"{len(rows) - len(missing)} of {len(rows)} runs done" +
          (f", {len(missing)} failed, tried again by the same command" if missing else ""))
    return 1 if missing else 0


def sweep(arguments):
    given = parse_arguments(arguments)
    if not given.plan_only:
        need(*(("sbatch", "slurm-client") if given.slurm else ("parallel", "parallel")))
    folder = begin(given)
    names, rows = folder.plan()
    if given.plan_only:
        print(folder.path / "plan.csv")
        return 0
    lock = hold(folder)

    def unfinished():
        return [number for number in range(len(rows)) if folder.summary(number) is None]

    if unfinished():  # tables of finished runs need no scene
        folder.begin(with_hashes(folder.asked()), names, rows)
    if given.slurm:
        through_slurm(folder, unfinished)
    elif numbers := unfinished():
        through_parallel(folder, numbers, given.jobs, given.sshloginfile)
    folder.clear_parts()
    table, times = make_tables(folder)
    write_tables(folder, table, times)
    status = report(folder, names, rows, table)
    print(folder.path / "table.csv")
    both = [row | measured for row, measured in zip(table, times)]
    for x, y in given.chart:
        print(draw_chart(folder, both, names, x, y))
    lock.close()
    return status


def stop(*_):
    raise KeyboardInterrupt


if __name__ == "__main__":
    signal.signal(signal.SIGTERM, stop)
    with one_line():
        try:
            sys.exit(sweep(sys.argv[1:]))
        except KeyboardInterrupt:
            print("sweep: stopped; the same command goes on", file=sys.stderr)
            sys.exit(130)
