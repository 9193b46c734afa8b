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
set key outside top center horizontal noenhanced
{tics}plot {plots}
{points}
"""

# Told apart by those who see no red or no green, too.
_COLOURS = ("#1f5fa8", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#6a3d9a", "#7f7f7f")
_POINTS = (7, 5, 9, 11, 13, 6, 4, 8)


def draw_chart(folder, rows, keys, x, y):
    """A PNG in the folder of the sweep, a point for each run that has both; InputError where there is no
    such column, or y is no number. Words along x stand beside one another. What the other swept keys were
    tells series apart by colour and sign, where there are not more than those."""
    columns = columns_of(rows)
    for column in (x, y):
        if column not in columns:
            near = difflib.get_close_matches(column, columns, 1)
            raise InputError(f"--chart {column}: no such column" +
                             (f", did you mean '{near[0]}'?" if near else ", expected one of table.csv"))
    others = [key for key in keys if key not in (x, y) and len({row.get(key) for row in rows}) > 1]
    pairs, series = [], []
    for row in rows:
        if row.get(x, "") != "" and row.get(y, "") != "":
            pairs.append((row[x], row[y]))
            series.append(", ".join(f"{key} = {row.get(key, '')}" for key in others))
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
    names = list(dict.fromkeys(series))
    if len(names) > len(_COLOURS):
        names, series = [""], [""] * len(series)
    script = _SCRIPT.format(
        x=_quoted(x), y=_quoted(y), tics=tics,
        plots=", ".join(f'"-" using 1:2 with points pt {point} ps 1.1 lc rgb "{colour}" ' +
                        (f"title {_quoted(name)}" if name else "notitle")
                        for name, colour, point in zip(names, _COLOURS, _POINTS)),
        points="\n".join("\n".join(f"{float(a)!r} {float(b)!r}" for (a, b), of in zip(pairs, series)
                                   if of == name) + "\ne" for name in names))
    drawn = subprocess.run(["gnuplot", "-d", "-"], input=script.encode(), capture_output=True, check=False)
    if drawn.returncode != 0:
        raise SweepError(f"gnuplot: {' '.join(drawn.stderr.decode(errors='replace').split())}")
    write_whole(file, drawn.stdout)
    return file


def _quoted(text):
    """What gnuplot might run, replace or end the string at stands by its octal number."""
    text = re.sub(r"[\x00-\x1f\x7f]", " ", str(text))
    return '"' + re.sub(r"[^\w .,:;/()=+-]", lambda c: "".join(f"\\{b:03o}" for b in c[0].encode()), text) + '"'
