"""Draws one column of the tables against another, by gnuplot."""

import difflib
import re
import subprocess

from errors import InputError, SweepError
from sweep_folder import write_whole
from table import columns_of

_SCRIPT = """set terminal pngcairo size 960,640 font "DejaVu Sans,12"
set xlabel {x} noenhanced
set ylabel {y} noenhanced
set grid
set offsets graph 0.03, graph 0.03, graph 0.05, 0
unset key
{tics}plot "-" using 1:2 with points pt 7 ps 0.9 lc rgb "#1f5fa8"
{points}
e
"""


def draw_chart(folder, rows, x, y):
    """A PNG in the folder of the sweep, a point for each run that has both; InputError where there is no
    such column, or y is no number. Words along x stand beside one another."""
    columns = columns_of(rows)
    for column in (x, y):
        if column not in columns:
            near = difflib.get_close_matches(column, columns, 1)
            raise InputError(f"--chart {column}: no such column" +
                             (f", did you mean '{near[0]}'?" if near else ", expected one of table.csv"))
    pairs = [(row[x], row[y]) for row in rows if row.get(x, "") != "" and row.get(y, "") != ""]
    for _, b in pairs:
        if not isinstance(b, (int, float)):
            raise InputError(f"--chart {x} {y}: {y} has '{b}', expected a column of numbers")
    if not pairs:
        raise SweepError(f"--chart {x} {y}: no run has both")
    tics = ""
    if not all(isinstance(a, (int, float)) for a, _ in pairs):
        places = {a: i for i, a in enumerate(dict.fromkeys(str(a) for a, _ in pairs))}
        words = ", ".join(f"{_quoted(word)} {place}" for word, place in places.items())
        tics = f"set xtics noenhanced ({words})\nset xrange [-0.5:{len(places) - 0.5}]\n"
        pairs = [(places[str(a)], b) for a, b in pairs]
    file = folder.path / (re.sub(r"[^\w.-]", "_", f"{x}-{y}") + ".png")
    script = _SCRIPT.format(x=_quoted(x), y=_quoted(y), tics=tics,
                            points="\n".join(f"{float(a)!r} {float(b)!r}" for a, b in pairs))
    drawn = subprocess.run(["gnuplot", "-d", "-"], input=script.encode(), capture_output=True, check=False)
    if drawn.returncode != 0:
        raise SweepError(f"gnuplot: {' '.join(drawn.stderr.decode(errors='replace').split())}")
    write_whole(file, drawn.stdout)
    return file


def _quoted(text):
    """What gnuplot might run, replace or end the string at stands by its octal number."""
    text = re.sub(r"[\x00-\x1f\x7f]", " ", str(text))
    return '"' + re.sub(r"[^\w .,:;/()=+-]", lambda c: "".join(f"\\{b:03o}" for b in c[0].encode()), text) + '"'
