"""One row per run, in the order of the plan, as CSV and HDF5. What a run measures of the machine (times,
memory, host) stands in tables of its own, so that the others are equal, byte for byte, wherever and
however often the same sweep ran."""

import csv
import io
import os

import h5py

from sweep_folder import write_whole

_OF_THE_MACHINE = {"frames", "instructions", "late_us", "load_s", "memory_MiB", "missed_ticks", "parts",
                   "realtime_refused", "stage_us", "tick_us", "wall_s"}


def flatten(value, name=""):
    """{"force_N.mean": 0.8, ...} of an object of JSON. What is in a list goes by its name, else by its
    place; null is left out."""
    if isinstance(value, dict):
        named = value.items()
    elif isinstance(value, list):
        named = [_named(i, item) for i, item in enumerate(value)]
    else:
        return {} if value is None else {name: value}
    flat = {}
    for key, item in named:
        flat.update(flatten(item, f"{name}.{key}" if name else str(key)))
    return flat


def _named(place, item):
    if not isinstance(item, dict) or "name" not in item:
        return place, item
    return item["name"], {key: value for key, value in item.items() if key != "name"}


def number_of(text):
    """A value of a swept key as a number, where it is one."""
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            pass
    return text


def make_tables(folder):
    """(table, times), each a list of rows, {column: value}, of all runs, also of those that failed"""
    names, rows = folder.plan()
    asked = folder.asked()
    table, times = [], []
    for number, values in enumerate(rows):
        swept = {name: number_of(value) for name, value in zip(names, values)}
        ended = folder.outcome(number)
        summary = folder.summary(number) or {}
        row = {"run": number, "exit_status": ended.get("exit_status", ""), **swept}
        if asked["seed"] is not None:
            row["seed"] = asked["seed"]
        # Where the summary tells a swept value as well, that of the plan stands.
        row |= {column: value
                for column, value in flatten({k: v for k, v in summary.items()
                                              if k not in _OF_THE_MACHINE}).items() if column not in row}
        table.append(row)
        measured = {k: v for k, v in summary.items() if k in _OF_THE_MACHINE}
        times.append({"run": number, "host": ended.get("host", ""), "attempts": ended.get("attempts", ""),
                      **flatten(measured)})
    return table, times


def columns_of(rows):
    """All columns, a row's own in its order."""
    return list(dict.fromkeys(column for row in rows for column in row))


def write_tables(folder, table, times):
    for name, rows in (("table", table), ("times", times)):
        write_whole(folder.path / f"{name}.csv", csv_bytes(rows))
        write_hdf5(folder, name, rows)


def csv_bytes(rows):
    """Numbers with all their digits; what a run does not have is empty."""
    text = io.StringIO()
    writer = csv.DictWriter(text, columns_of(rows), restval="", lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return text.getvalue().encode()


def write_hdf5(folder, name, rows):
    """A data set per column, as long as the table: whole numbers, numbers (NaN where there is none) or
    texts. Attributes say what was asked for."""
    file = folder.path / f"{name}.h5"
    part = file.with_name(f"{file.name}.part-{os.getpid()}")
    asked = folder.asked()
    # Without the order of creation, with which HDF5 keeps the time of day as well.
    with h5py.File(part, "w") as out:
        out.attrs["format"] = "sulcus-sweep"
        out.attrs["scene"] = asked["scene"]
        out.attrs["scene_sha256"] = asked["scene_sha256"]
        out.attrs["options"] = " ".join(asked["options"])
        if asked["seed"] is not None:
            out.attrs["seed"] = asked["seed"]
        for column in columns_of(rows):
            values = [row.get(column, "") for row in rows]
            out.create_dataset(column.replace("/", "_"), **_column(values))
    part.replace(file)


def _column(values):
    """What create_dataset() takes."""
    present = [value for value in values if value != ""]
    if present and all(isinstance(value, int) for value in present) and len(present) == len(values) \
            and all(abs(value) < 2**63 for value in present):
        return {"data": [int(value) for value in values], "dtype": "i8"}
    if present and all(isinstance(value, (int, float)) for value in present):
        return {"data": [float("nan") if value == "" else float(value) for value in values], "dtype": "f8"}
    texts = [str(value).encode() for value in values]
    length = max(1, *map(len, texts)) if texts else 1
    return {"data": texts, "dtype": h5py.string_dtype("utf-8", length)}
