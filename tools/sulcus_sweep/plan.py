"""Which runs a sweep has: every combination of some values, or a Latin hypercube of them."""

import itertools
import random
import re
from dataclasses import dataclass

from errors import InputError

# Ends of a range as whole numbers give whole numbers, as in TOML.
_NUMBER = r"[+-]?\d+(?:\.\d+)?(?:[eE][+-]?\d+)?"
_RANGE = re.compile(rf"({_NUMBER}):({_NUMBER})")
_BRACKETS = {"[": "]", "{": "}"}


@dataclass(frozen=True)
class Range:
    """Values from low to high; of whole numbers both ends may come up."""

    low: float
    high: float
    whole: bool

    def at(self, u):
        """The value, as text for TOML, at u in [0, 1)."""
        if self.whole:
            return str(self.low + int(u * (self.high - self.low + 1)))
        return repr(self.low + u * (self.high - self.low))


@dataclass(frozen=True)
class SweptKey:
    """A key of the scene, and the values that it takes: texts, or a Range."""

    name: str
    values: object

    def at(self, u):
        if isinstance(self.values, Range):
            return self.values.at(u)
        return self.values[int(u * len(self.values))]

    def to_check(self):
        """Values that tell whether the scene takes this key: each, or the ends of a range."""
        if isinstance(self.values, Range):
            return [self.values.at(0.0), self.values.at(1.0 - 2.0**-53)]
        return self.values


def split_values(text):
    """Parts between the commas that stand in no brackets and no quotes."""
    parts, start, closing, quote = [], 0, [], ""
    for i, c in enumerate(text):
        if quote:
            quote = "" if c == quote else quote
        elif c in "\"'":
            quote = c
        elif c in _BRACKETS:
            closing.append(_BRACKETS[c])
        elif closing and c == closing[-1]:
            closing.pop()
        elif c == "," and not closing:
            parts.append(text[start:i].strip())
            start = i + 1
    parts.append(text[start:].strip())
    return parts


def parse_set(text, latin):
    """The SweptKey of `KEY=VALUE,...`, or with `latin` of `KEY=LOW:HIGH`; InputError."""
    where = f"--set {text}"
    name, equals, values = text.partition("=")
    name = name.strip()
    if not equals or not name:
        raise InputError(f"{where}: no key with values, expected KEY=VALUE,VALUE,...")
    ends = _RANGE.fullmatch(values.strip())
    if ends and not latin:
        raise InputError(f"{where}: a range, expected values with commas, or --latin N")
    if ends:
        whole = all(re.fullmatch(r"[+-]?\d+", end) for end in ends.groups())
        low, high = (int(end) if whole else float(end) for end in ends.groups())
        if not low < high:
            raise InputError(f"{where}: from {ends[1]} to {ends[2]}, expected LOW below HIGH")
        return SweptKey(name, Range(low, high, whole))
    parts = split_values(values)
    if "" in parts:
        raise InputError(f"{where}: value {parts.index('') + 1} is empty, expected VALUE,VALUE,...")
    twice = next((part for part in parts if parts.count(part) > 1), None)
    if twice is not None:
        raise InputError(f"{where}: {twice} stands there twice, expected each value once")
    return SweptKey(name, parts)


def parse_sets(texts, latin):
    keys = [parse_set(text, latin) for text in texts]
    for key in keys:
        if sum(other.name == key.name for other in keys) > 1:
            raise InputError(f"--set {key.name}: given twice, expected all its values in one --set")
    return keys


def all_combinations(keys):
    """Rows of values; the last key changes fastest."""
    return [list(row) for row in itertools.product(*(key.values for key in keys))]


def latin_hypercube(keys, count, seed):
    """`count` rows; of each key's range every one of `count` equal parts is met once [McKay, Beckman,
    Conover 1979]. The same seed gives the same rows on any machine."""
    rng = random.Random(seed)
    columns = []
    for key in keys:
        # Sorted by random numbers: shuffle() may change between versions of Python, random() may not.
        parts = sorted(range(count), key=lambda _: rng.random())
        columns.append([key.at(min((part + rng.random()) / count, 1.0 - 2.0**-53)) for part in parts])
    return [list(row) for row in zip(*columns)]
