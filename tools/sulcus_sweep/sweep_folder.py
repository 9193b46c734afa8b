"""What lies on disk, and alone says what is done:

    sweep.json          what was asked for
    plan.csv            the runs: number, seed of the hypercube, values, folder
    runs/000012/        run 12, finished: what `sulcus run` wrote
    runs/000012.failed/ run 12, failed: the same, as far as it came, with error.txt
    runs/000012.part-*  run 12, at work or killed

A run works in a folder of its own and gives it its name when its summary is whole, so that a kill at any
moment, also while the sweep goes on already, leaves nothing that is taken for a result."""

import csv
import io
import json
import os
import pathlib
import shutil
import socket

from errors import InputError


class SweepFolder:
    """The folder of a sweep. Numbers count the runs from 0, in the order of the plan."""

    def __init__(self, path):
        self.path = pathlib.Path(path).resolve()
        self.runs = self.path / "runs"

    def run_folder(self, number):
        return self.runs / f"{number:06d}"

    def failed_folder(self, number):
        return self.runs / f"{number:06d}.failed"

    def part_folder(self, number):
        return self.runs / f"{number:06d}.part-{socket.gethostname()}-{os.getpid()}"

    def asked(self):
        """What sweep.json says; None where there is none. InputError where it is damaged."""
        file = self.path / "sweep.json"
        if not file.exists():
            return None
        asked = read_json(file) or {}
        kinds = {"scene": str, "scene_sha256": str, "set": list, "latin": int | None, "seed": int | None,
                 "options": list, "program": str, "started_in": str}
        files = asked.get("files_sha256", {})
        is_whole = all(name in asked and isinstance(asked[name], kind) for name, kind in kinds.items()) and \
            all(isinstance(text, str) for text in asked["set"] + asked["options"]) and isinstance(files, dict)
        if not is_whole:
            raise InputError(f"{file}: is damaged, expected it as the sweep wrote it")
        return asked

    def plan(self):
        """(names of the swept keys, rows of values)"""
        with open(self.path / "plan.csv", newline="", encoding="utf-8") as file:
            header, *rows = csv.reader(file)
        return header[2:-1], [row[2:-1] for row in rows]

    def begin(self, asked, names, rows):
        """Writes the plan, or finds the same one there; InputError if there is another. runs/ is made
        last, so that the same command goes on after a kill in here."""
        plan = _plan_text(names, rows, asked["seed"])
        before = self.asked()
        if before is not None:
            for what, found in asked.items():
                if what != "files_sha256" and before.get(what) != found:
                    raise InputError(
                        f"{self.path}: holds a sweep with another {what} ({_short(before.get(what))}, now "
                        f"{_short(found)}), expected the same or another folder")
            _check_files(self.path, before.get("files_sha256"), asked.get("files_sha256"))
            if not self._has_plan(plan):
                raise InputError(f"{self.path / 'plan.csv'}: is damaged, expected the plan of sweep.json")
            self.runs.mkdir(exist_ok=True)
            return
        if self.runs.exists():
            raise InputError(f"{self.path}: has runs/ but no sweep.json, expected a sweep or a new folder")
        try:
            self.path.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise InputError(f"{self.path}: is no folder and cannot be made ({error.strerror}), expected one "
                             "that can") from None
        write_whole(self.path / "plan.csv", plan)
        write_whole(self.path / "sweep.json", (json.dumps(asked, indent=1) + "\n").encode())
        self.runs.mkdir()

    def _has_plan(self, plan):
        try:
            return (self.path / "plan.csv").read_bytes() == plan
        except OSError:
            return False

    def summary(self, number):
        """summary.json of a finished run; None where it is missing, cut short or of a run that was told
        to stop."""
        return whole_summary(self.run_folder(number))

    def outcome(self, number):
        """How a run ended: {exit_status, attempts, host}, {} where it has not."""
        for folder in (self.run_folder(number), self.failed_folder(number)):
            if (ended := read_json(folder / "run.json")) is not None:
                return ended
        return {}

    def error(self, number):
        """The last line of what a failed run said."""
        try:
            text = (self.failed_folder(number) / "error.txt").read_text(errors="replace")
        except OSError:
            return "it left no word; it may have been killed"
        lines = [line for line in text.splitlines() if line.strip()]
        return lines[-1].strip() if lines else "it said nothing"

    def clear_parts(self):
        """What killed runs left; while no run is at work."""
        for part in self.runs.glob("*.part-*"):
            shutil.rmtree(part, ignore_errors=True)


def _plan_text(names, rows, seed):
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(["run", "seed", *names, "folder"])
    for number, row in enumerate(rows):
        writer.writerow([number, seed, *row, f"runs/{number:06d}"])
    return text.getvalue().encode()


def _check_files(path, before, now):
    """Sweeps of earlier versions (None) know of none."""
    if before is None or now is None:
        return
    for file in sorted(before.keys() | now.keys()):
        if before.get(file) != now.get(file):
            raise InputError(f"{file}: is not what it was when the sweep in {path} began, expected the same "
                             "or another folder")


def whole_summary(folder):
    summary = read_json(folder / "summary.json")
    return None if summary is None or summary.get("interrupted") else summary


def read_json(file):
    """The object in a file; None where there is no file or no whole one in it."""
    try:
        value = json.loads(file.read_bytes())
    except (OSError, ValueError):
        return None
    return value if isinstance(value, dict) else None


def write_whole(file, data):
    """A file that is there whole or not at all."""
    part = file.with_name(f"{file.name}.part-{os.getpid()}")
    part.write_bytes(data)
    part.replace(file)


def _short(value):
    text = str(value)
    return text if len(text) <= 60 else text[:57] + "..."
