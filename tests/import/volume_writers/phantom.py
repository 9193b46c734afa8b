"""The phantom that is written, and the lines of truth.txt that say what a reader should make of it."""

import os
import sys

import numpy as np

OUT = sys.argv[1]
TRUTH = []

SIZE = (40, 30, 20)  # x, y, z
SPACING = (0.3, 0.4, 0.5)
ORIGIN = (-10.0, 5.0, 100.0)


def phantom():
    """Three labels, in no mirror their own; [x, y, z]."""
    v = np.zeros(SIZE, np.int16)
    v[6:28, 5:17, 4:12] = 1
    v[20:28, 10:17, 9:12] = 0
    v[30:36, 6:10, 3:9] = 2
    v[8:12, 20:26, 12:17] = 3
    return v


def lattice(directions=np.eye(3), origin=ORIGIN, spacing=SPACING):
    """LPS mm from index."""
    a = np.eye(4)
    a[:3, :3] = np.asarray(directions, float) @ np.diag(spacing)
    a[:3, 3] = origin
    return a


def turned(volume, affine, order=(0, 1, 2), flips=()):
    """The same solid at the same place, its axes in another order or sense."""
    affine = affine.copy()
    for axis in flips:
        affine[:3, 3] += affine[:3, axis] * (volume.shape[axis] - 1)
        affine[:3, axis] *= -1
        volume = np.flip(volume, axis)
    columns = affine[:3, :3][:, list(order)]
    affine[:3, :3] = columns
    return np.transpose(volume, order), affine


def rotation(x=0.0, y=0.0, z=0.0):
    cx, sx, cy, sy, cz, sz = np.cos(x), np.sin(x), np.cos(y), np.sin(y), np.cos(z), np.sin(z)
    return (np.array([[cz, -sz, 0], [sz, cz, 0], [0, 0, 1]])
            @ np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])
            @ np.array([[1, 0, 0], [0, cx, -sx], [0, sx, cx]]))


PHANTOM = phantom()
UPRIGHT = lattice()
OBLIQUE = lattice(rotation(0.3, -0.2, 0.5))
# Planes turned by 15 degrees about x, and stacked along z: a tilted gantry.
TILT = lattice(np.column_stack([(1, 0, 0), rotation(x=np.radians(-15))[:, 1], (0, 0, 1)]))
FLIPPED = turned(PHANTOM, UPRIGHT, flips=(0,))  # left-handed
PERMUTED = turned(PHANTOM, UPRIGHT, order=(2, 0, 1), flips=(1,))


def path(name):
    full = os.path.join(OUT, name)
    os.makedirs(os.path.dirname(full), exist_ok=True)
    return full


def places(volume, affine):
    numbers = []
    for label in (1, 2, 3):
        index = np.argwhere(volume == label)
        middle = affine @ np.append(index.mean(axis=0), 1.0)
        numbers += [*middle[:3], len(index) * abs(np.linalg.det(affine[:3, :3]))]
    return " ".join("%.9g" % n for n in numbers)


def read(name, volume=PHANTOM, affine=UPRIGHT, offset=0.0, slope=1.0):
    TRUTH.append("read %s %.9g %.9g %s" % (name, offset, slope, places(volume, affine)))


def ask(name, volume=PHANTOM, offset=0.0, slope=1.0, spacing=SPACING, affine=None):
    if affine is None:
        affine = lattice(origin=(0, 0, 0), spacing=spacing)
    TRUTH.append("ask %s %.9g %.9g %s %s" % (name, offset, slope, "%g %g %g" % tuple(spacing),
                                             places(volume, affine)))


def refuse(name, text):
    TRUTH.append("refuse %s %s" % (name, text))


def flat(volume, dtype="<i2"):
    """x fastest."""
    return volume.astype(dtype).tobytes(order="F")


def frames(volume, dtype="<i2"):
    return np.ascontiguousarray(np.transpose(volume, (2, 1, 0)).astype(dtype))


def write(name, *parts):
    with open(path(name), "wb") as f:
        for part in parts:
            f.write(part if isinstance(part, bytes) else part.encode("latin-1"))
