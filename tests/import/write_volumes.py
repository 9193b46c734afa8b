"""Writes one phantom in more than a hundred ways, and what a reader should make of each.

    write_volumes.py FOLDER

The writers are not those of the program under test: pydicom, nibabel, tifffile, Pillow, GDCM and DCMTK for
what DICOM packs pixels by, and for NRRD and MetaImage the bytes themselves. FOLDER/truth.txt has a line for
each file or folder of slices:

    read NAME OFFSET SLOPE then for labels 1 to 3: x y z mm3     grey = OFFSET + SLOPE * label
    ask NAME OFFSET SLOPE dx dy dz then the same                 the file does not say its spacing
    refuse NAME TEXT                                             what the line must hold
"""

import bz2
import copy
import gzip
import os
import random
import struct
import subprocess
import sys
import zlib

import gdcm
import nibabel
import numpy as np
import pydicom
import tifffile
from PIL import Image
from pydicom.dataset import Dataset, FileDataset, FileMetaDataset
from pydicom.sequence import Sequence
from pydicom.encaps import encapsulate, generate_pixel_data_frame
from pydicom.uid import (CTImageStorage, DeflatedExplicitVRLittleEndian, EnhancedCTImageStorage,
                         ExplicitVRBigEndian, ExplicitVRLittleEndian, ImplicitVRLittleEndian,
                         JPEG2000Lossless, JPEGLosslessSV1, JPEGLSLossless, RLELossless, generate_uid)

gdcm.Trace.WarningOff()
gdcm.Trace.ErrorOff()

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


def write(name, *parts):
    with open(path(name), "wb") as f:
        for part in parts:
            f.write(part if isinstance(part, bytes) else part.encode("latin-1"))


# ---------------------------------------------------------------- NRRD


def vectors(affine, signs=(1, 1, 1), unit=1.0):
    rows = np.diag(signs) @ affine[:3, :3] / unit
    return " ".join("(" + ",".join("%.17g" % n for n in rows[:, d]) + ")" for d in range(3))


def vector(values, signs=(1, 1, 1), unit=1.0):
    return "(" + ",".join("%.17g" % n for n in np.multiply(signs, values) / unit) + ")"


def nrrd_header(volume, affine, space="left-posterior-superior", signs=(1, 1, 1), unit=1.0,
                encoding="raw", endian="little", type_="short", more="", magic="NRRD0004",
                sizes=None, dimension=3, directions=None):
    return ("%s\n# made by hand\ntype: %s\ndimension: %d\n%s%ssizes: %s\nspace directions: %s\n"
            "space origin: %s\n%sencoding: %s\n%s" %
            (magic, type_, dimension, "space: %s\n" % space if space else "", "",
             sizes or "%d %d %d" % volume.shape, directions or vectors(affine, signs, unit),
             vector(affine[:3, 3], signs, unit), "endian: %s\n" % endian if endian else "",
             encoding, more))


def nrrd():
    v, a = PHANTOM, UPRIGHT
    raw, big = flat(v), flat(v, ">i2")
    write("n/plain.nrrd", nrrd_header(v, a), "\n", raw)
    read("n/plain.nrrd")
    write("n/big_endian.nrrd", nrrd_header(v, a, endian="big"), "\n", big)
    read("n/big_endian.nrrd")
    for name, signs in (("right-anterior-superior", (-1, -1, 1)), ("RAS", (-1, -1, 1)),
                        ("left-anterior-superior", (1, -1, 1)), ("LPS", (1, 1, 1))):
        write("n/%s.nrrd" % name, nrrd_header(v, OBLIQUE, space=name, signs=signs), "\n", raw)
        read("n/%s.nrrd" % name, v, OBLIQUE)
    write("n/scanner.nrrd", nrrd_header(v, a, space="scanner-xyz"), "\n", raw)
    read("n/scanner.nrrd")
    write("n/space_dimension.nrrd", nrrd_header(v, a, space=None, more="space dimension: 3\n"), "\n",
          raw)
    read("n/space_dimension.nrrd")
    write("n/gzip.nrrd", nrrd_header(v, a, encoding="gzip"), "\n", gzip.compress(raw))
    read("n/gzip.nrrd")
    write("n/gzip_members.nrrd", nrrd_header(v, a, encoding="gz"), "\n", gzip.compress(raw[:5000]),
          gzip.compress(raw[5000:]))
    read("n/gzip_members.nrrd")
    write("n/bzip2.nrrd", nrrd_header(v, a, encoding="bzip2", endian="big"), "\n", bz2.compress(big))
    read("n/bzip2.nrrd")
    write("n/text.nrrd", nrrd_header(v, a, encoding="ascii", endian=None), "\n",
          "\n".join(str(n) for n in v.flatten(order="F")), "\n")
    read("n/text.nrrd")
    write("n/hex.nrrd", nrrd_header(v, a, encoding="hex"), "\n", raw.hex())
    read("n/hex.nrrd")
    for type_, dtype in (("float", "<f4"), ("double", "<f8"), ("uchar", "u1"), ("int8_t", "i1"),
                         ("unsigned int", "<u4"), ("long long", "<i8")):
        name = "n/%s.nrrd" % type_.replace(" ", "_")
        write(name, nrrd_header(v, a, type_=type_), "\n", flat(v, dtype))
        read(name)
    write("n/detached.nhdr", nrrd_header(v, a, more="data file: detached.raw\n"))
    write("n/detached.raw", raw)
    read("n/detached.nhdr")
    write("n/two words.nhdr", nrrd_header(v, a, encoding="gzip", more="data file: two words.raw.gz\n"))
    write("n/two words.raw.gz", gzip.compress(raw))
    # A name with a blank cannot stand in the list: it goes by a link.
    os.symlink("two words.nhdr", path("n/two_words.nhdr"))
    read("n/two_words.nhdr")
    for k in range(SIZE[2]):
        write("n/slice%02d.raw" % k, flat(v[:, :, k]))
    write("n/list.nhdr", nrrd_header(v, a, more="data file: LIST\n"),
          "".join("slice%02d.raw\n" % k for k in range(SIZE[2])))
    read("n/list.nhdr")
    write("n/pattern.nhdr", nrrd_header(v, a, more="data file: slice%%02d.raw 0 %d 1\n" % (SIZE[2] - 1)))
    read("n/pattern.nhdr")
    write("n/pattern_back.nhdr",
          nrrd_header(*turned(v, a, flips=(2,)), more="data file: slice%%02d.raw %d 0 -1\n" % (SIZE[2] - 1)))
    read("n/pattern_back.nhdr")
    write("n/byte_skip.nrrd", nrrd_header(v, a, more="byte skip: 16\n"), "\n", b"x" * 16, raw)
    read("n/byte_skip.nrrd")
    write("n/byte_skip_packed.nrrd", nrrd_header(v, a, encoding="gzip", more="byte skip: 16\n"), "\n",
          gzip.compress(b"x" * 16 + raw))
    read("n/byte_skip_packed.nrrd")
    write("n/from_the_end.nrrd", nrrd_header(v, a, more="byte skip: -1\n"), "\n", b"x" * 77, raw)
    read("n/from_the_end.nrrd")
    write("n/line_skip.nrrd", nrrd_header(v, a, more="line skip: 2\n"), "\n", "one\ntwo\n", raw)
    read("n/line_skip.nrrd")
    for unit, mm in (("um", 1e-3), ("m", 1e3), ("cm", 10.0), ("microns", 1e-3)):
        units = " ".join(['"%s"' % unit] * 3)
        write("n/in_%s.nrrd" % unit, nrrd_header(v, a, unit=mm, more="space units: %s\n" % units), "\n", raw)
        read("n/in_%s.nrrd" % unit)
    mixed = a.copy()
    mixed[2] *= 1e3
    write("n/mixed_units.nrrd", nrrd_header(v, mixed, more='space units: "mm" "mm" "um"\n'), "\n", raw)
    read("n/mixed_units.nrrd")
    for name, (tv, ta) in (("left_handed", FLIPPED), ("permuted", PERMUTED)):
        write("n/%s.nrrd" % name, nrrd_header(tv, ta), "\n", flat(tv))
        read("n/%s.nrrd" % name)
    write("n/sheared.nrrd", nrrd_header(v, TILT), "\n", raw)
    read("n/sheared.nrrd", v, TILT)
    write("n/vector_axis.nrrd", nrrd_header(v, a, dimension=4, sizes="1 %d %d %d" % SIZE,
                                            directions="none " + vectors(a),
                                            more="kinds: vector domain domain domain\n"), "\n", raw)
    read("n/vector_axis.nrrd")
    write("n/time_axis.nrrd", nrrd_header(v, a, dimension=4, sizes="%d %d %d 1" % SIZE,
                                          directions=vectors(a) + " none",
                                          more="kinds: space space space time\n"), "\n", raw)
    read("n/time_axis.nrrd")
    write("n/notes.nrrd", nrrd_header(v, a, more="spacings:=1 1 1\nspace units:=\"m\" \"m\" \"m\"\n"),
          "\n", raw)
    read("n/notes.nrrd")
    plain = "NRRD0003\ntype: short\ndimension: 3\nsizes: %d %d %d\nencoding: raw\nendian: little\n" % SIZE
    mins = "%g %g %g" % ORIGIN
    write("n/axis_mins_node.nrrd", plain, "spacings: 0.3 0.4 0.5\naxis mins: %s\n" % mins,
          "centers: node node node\n\n", raw)
    read("n/axis_mins_node.nrrd")
    low = np.subtract(ORIGIN, np.multiply(SPACING, 0.5))
    high = low + np.multiply(SPACING, SIZE)
    write("n/axis_mins_cell.nrrd", plain, "axis mins: %g %g %g\naxis maxs: %g %g %g\n" % (*low, *high),
          "centers: cell cell cell\n\n", raw)
    read("n/axis_mins_cell.nrrd")
    write("n/units_of_axes.nrrd", plain, "spacings: 300 400 500\nunits: \"um\" \"um\" \"um\"\n\n", raw)
    read("n/units_of_axes.nrrd", v, lattice(origin=(0, 0, 0)))

    write("n/no_spacing.nrrd", plain, "\n", raw)
    ask("n/no_spacing.nrrd")

    write("n/cut.nrrd", nrrd_header(v, a), "\n", raw[:-7])
    refuse("n/cut.nrrd", "data: found 47993 bytes, expected 48000")
    write("n/longer.nrrd", nrrd_header(v, a), "\n", raw + b"1")
    refuse("n/longer.nrrd", "data: found 48001 bytes, expected 48000")
    packed = bytearray(gzip.compress(raw))
    packed[-6] ^= 1
    write("n/checksum.nrrd", nrrd_header(v, a, encoding="gzip"), "\n", bytes(packed))
    refuse("n/checksum.nrrd", "data: found compressed data that are damaged")
    packed = bytearray(bz2.compress(raw))
    packed[len(packed) // 2] ^= 4
    write("n/checksum_bzip2.nrrd", nrrd_header(v, a, encoding="bzip2"), "\n", bytes(packed))
    refuse("n/checksum_bzip2.nrrd", "data: found compressed data that are damaged")
    write("n/furlongs.nrrd", nrrd_header(v, a, more='space units: "furlong" "furlong" "furlong"\n'), "\n", raw)
    refuse("n/furlongs.nrrd", "space units: found \"furlong\"")
    write("n/no_endian.nrrd", nrrd_header(v, a, endian=None), "\n", raw)
    refuse("n/no_endian.nrrd", "endian: found no such field")
    write("n/no_space.nrrd", nrrd_header(v, a, space=None), "\n", raw)
    refuse("n/no_space.nrrd", "space: found none beside space directions")
    write("n/colours.nrrd", nrrd_header(v, a, dimension=4, sizes="3 40 30 20", type_="uchar",
                                        directions="none " + vectors(a)), "\n", b"\0" * 72000)
    refuse("n/colours.nrrd", "found an axis of 3 that is not of space")
    write("n/absent.nhdr", nrrd_header(v, a, more="data file: slice%02d.raw 0 30 1\n"))
    refuse("n/absent.nhdr", "data file: found \"slice20.raw\", expected a file that exists")


# ---------------------------------------------------------------- MetaImage


def meta(volume, affine, data="LOCAL", type_="MET_SHORT", more="", spacing=True, matrix=True, unit=1.0):
    steps = affine[:3, :3]
    lengths = np.linalg.norm(steps, axis=0)
    text = "ObjectType = Image\nNDims = 3\n"
    if "BinaryData =" not in more:
        text += "BinaryData = True\n"
    if "MSB" not in more:
        text += "BinaryDataByteOrderMSB = False\n"
    if matrix:
        text += "TransformMatrix = %s\n" % " ".join("%.17g" % n for n in (steps / lengths).T.flatten())
    text += "Offset = %s\n" % " ".join("%.17g" % n for n in affine[:3, 3] / unit)
    if spacing:
        text += "ElementSpacing = %s\n" % " ".join("%.17g" % n for n in lengths / unit)
    return text + "%sDimSize = %d %d %d\nElementType = %s\nElementDataFile = %s\n" % (
        more, *volume.shape, type_, data)


def meta_image():
    v, a = PHANTOM, UPRIGHT
    raw, big, packed = flat(v), flat(v, ">i2"), zlib.compress(flat(v))
    write("m/plain.mha", meta(v, a), raw)
    read("m/plain.mha")
    write("m/msb.mha", meta(v, a, more="BinaryDataByteOrderMSB = True\n"), big)
    read("m/msb.mha")
    write("m/element_msb.mha", meta(v, a, more="ElementByteOrderMSB = True\n"), big)
    read("m/element_msb.mha")
    write("m/packed.mha", meta(v, a, more="CompressedData = True\n"), packed)
    read("m/packed.mha")
    write("m/packed_size.mha", meta(v, a, more="CompressedData = True\nCompressedDataSize = %d\n" % len(packed)),
          packed)
    read("m/packed_size.mha")
    write("m/detached.mhd", meta(v, a, data="detached.raw"))
    write("m/detached.raw", raw)
    read("m/detached.mhd")
    write("m/detached_packed.mhd", meta(v, a, data="detached.zraw", more="CompressedData = True\n"))
    write("m/detached.zraw", packed)
    read("m/detached_packed.mhd")
    for k in range(SIZE[2]):
        write("m/slice%03d.raw" % (k + 1), flat(v[:, :, k]))
    write("m/list.mhd", meta(v, a, data="LIST"), "".join("slice%03d.raw\n" % (k + 1) for k in range(SIZE[2])))
    read("m/list.mhd")
    write("m/pattern.mhd", meta(v, a, data="slice%%03d.raw 1 %d 1" % SIZE[2]))
    read("m/pattern.mhd")
    write("m/header_size.mhd", meta(v, a, data="header_size.raw", more="HeaderSize = 12\n"))
    write("m/header_size.raw", b"twelve bytes", raw)
    read("m/header_size.mhd")
    write("m/from_the_end.mhd", meta(v, a, data="header_size.raw", more="HeaderSize = -1\n"))
    read("m/from_the_end.mhd")
    write("m/text.mha", meta(v, a, more="BinaryData = False\n"), " ".join(str(n) for n in v.flatten(order="F")))
    read("m/text.mha")
    for type_, dtype in (("MET_UCHAR", "u1"), ("MET_CHAR", "i1"), ("MET_FLOAT", "<f4"), ("MET_DOUBLE", "<f8"),
                         ("MET_LONG_LONG", "<i8"), ("MET_UINT", "<u4")):
        write("m/%s.mha" % type_, meta(v, a, type_=type_), flat(v, dtype))
        read("m/%s.mha" % type_)
    for name, (tv, ta) in (("left_handed", FLIPPED), ("permuted", PERMUTED), ("oblique", (v, OBLIQUE)),
                           ("sheared", (v, TILT))):
        write("m/%s.mha" % name, meta(tv, ta), flat(tv))
        read("m/%s.mha" % name, tv, ta)
    tv, ta = turned(v, a, flips=(0, 1))
    write("m/sides.mha", meta(tv, ta, matrix=False, more="AnatomicalOrientation = LPI\n"), flat(tv))
    read("m/sides.mha")
    write("m/micrometres.mha", meta(v, a, unit=1e-3, more="DistanceUnits = um\n"), raw)
    read("m/micrometres.mha")
    write("m/element_size.mha", meta(v, a, spacing=False, more="ElementSize = 0.3 0.4 0.5\n"), raw)
    read("m/element_size.mha")
    write("m/intensity.mha", meta(v, a, more="ElementToIntensityFunctionSlope = 500\n"
                                             "ElementToIntensityFunctionOffset = -1000\n"), raw)
    read("m/intensity.mha", offset=-1000, slope=500)
    write("m/four_axes.mha", "ObjectType = Image\nNDims = 4\nDimSize = 40 30 20 1\nElementSpacing = 0.3 0.4 0.5 1\n"
          "Offset = -10 5 100 0\nElementType = MET_SHORT\nElementDataFile = LOCAL\n", raw)
    read("m/four_axes.mha")

    write("m/no_spacing.mha", meta(v, a, spacing=False), raw)
    ask("m/no_spacing.mha", affine=a)

    zeros = packed[:len(packed) // 3] + b"\0" * (len(packed) - len(packed) // 3)
    write("m/zero_tail.mha", meta(v, a, more="CompressedData = True\n"), zeros)
    refuse("m/zero_tail.mha", "data: found ")
    wrong = bytearray(packed)
    wrong[-1] ^= 1
    write("m/checksum.mha", meta(v, a, more="CompressedData = True\n"), bytes(wrong))
    refuse("m/checksum.mha", "data: found compressed data that are damaged")
    write("m/short_stream.mha", meta(v, a, more="CompressedData = True\n"), zlib.compress(raw[:-2]))
    refuse("m/short_stream.mha", "data: found 47998 bytes, expected 48000")
    write("m/long_stream.mha", meta(v, a, more="CompressedData = True\n"), zlib.compress(raw + b"xy"))
    refuse("m/long_stream.mha", "data: found more than 48000 bytes")
    write("m/negative.mha", meta(v, a, spacing=False, more="ElementSpacing = 0.3 -0.4 0.5\n"), raw)
    refuse("m/negative.mha", "ElementSpacing: found -0.4, expected a positive length")
    write("m/field_behind.mhd", meta(v, a, data="detached.raw"), "ElementSpacing = 1 1 1\n")
    refuse("m/field_behind.mhd", "ElementDataFile: found \"ElementSpacing = 1 1 1\" behind it")
    write("m/channels.mha", meta(v, a, more="ElementNumberOfChannels = 3\n"), raw * 3)
    refuse("m/channels.mha", "ElementNumberOfChannels: found 3, expected 1")


# ---------------------------------------------------------------- NIfTI

RAS = np.diag([-1.0, -1.0, 1.0, 1.0])


def nifti_image(volume, affine, dtype=np.int16, cls=nibabel.Nifti1Image, sform=1, qform=1, unit="mm", scale=1.0):
    ras = RAS @ affine
    ras[:3] *= scale
    image = cls(np.ascontiguousarray(volume.astype(dtype)), ras)
    image.set_sform(ras if sform else None, sform)
    image.set_qform(ras if qform else None, qform)
    if not sform and not qform:
        image.header["pixdim"][1:4] = np.linalg.norm(ras[:3, :3], axis=0)
    image.header.set_xyzt_units(unit)
    return image


def nifti():
    v, a = PHANTOM, UPRIGHT

    def save(name, image, *truth, **more):
        nibabel.save(image, path("i/" + name))
        read("i/" + name, *truth, **more)

    save("plain.nii", nifti_image(v, a))
    save("packed.nii.gz", nifti_image(v, OBLIQUE), v, OBLIQUE)
    save("sform_alone.nii", nifti_image(v, OBLIQUE, qform=0), v, OBLIQUE)
    save("qform_alone.nii", nifti_image(v, OBLIQUE, sform=0), v, OBLIQUE)
    for name, (tv, ta) in (("left_handed", FLIPPED), ("permuted", PERMUTED)):
        save("%s_sform.nii" % name, nifti_image(tv, ta, qform=0), tv, ta)
        save("%s_qform.nii" % name, nifti_image(tv, ta, sform=0), tv, ta)
    save("sheared.nii", nifti_image(v, TILT, qform=0), v, TILT)
    save("micrometres.nii", nifti_image(v, a, unit="micron", scale=1e3))
    save("metres.nii", nifti_image(v, a, unit="meter", scale=1e-3))
    save("no_unit.nii", nifti_image(v, a, unit="unknown"))
    save("disagree.nii", disagreeing(v, a), v, a)
    for dtype in (np.uint8, np.int8, np.uint16, np.int32, np.uint32, np.float32, np.float64):
        save("%s.nii" % np.dtype(dtype).name, nifti_image(v, a, dtype))
    image = nifti_image(v, a)
    image.header.set_slope_inter(500, -1000)  # of what is stored: the labels themselves
    save("scaled.nii", image, offset=-1000, slope=500)
    save("second.nii", nifti_image(v, OBLIQUE, cls=nibabel.Nifti2Image), v, OBLIQUE)
    save("pair.img", nifti_image(v, OBLIQUE, cls=nibabel.Nifti1Pair), v, OBLIQUE)
    read("i/pair.hdr", v, OBLIQUE)
    save("second_pair.img.gz", nifti_image(v, OBLIQUE, cls=nibabel.Nifti2Pair), v, OBLIQUE)
    big = nifti_image(v, OBLIQUE)
    big = nibabel.Nifti1Image(v, RAS @ OBLIQUE, big.header.as_byteswapped(">"))
    save("big_endian.nii", big, v, OBLIQUE)
    four = nibabel.Nifti1Image(v[..., np.newaxis], RAS @ a)
    four.header.set_xyzt_units("mm", "sec")
    save("four_axes.nii", four)
    extended = nifti_image(v, a)
    extended.header.extensions.append(nibabel.nifti1.Nifti1Extension("comment", b"something of another program"))
    save("extension.nii", extended)

    whole = open(path("i/plain.nii"), "rb").read()
    packed = open(path("i/packed.nii.gz"), "rb").read()

    def patched(name, at, value, says):
        write("i/" + name, whole[:at] + value + whole[at + len(value):])
        refuse("i/" + name, says)

    write("i/cut.nii", whole[:-5])
    refuse("i/cut.nii", "data: found 47995 bytes, expected at least 48000")
    write("i/cut.nii.gz", packed[:-12])
    refuse("i/cut.nii.gz", "data: found compressed data that break off")
    damaged = bytearray(packed)
    damaged[-5] ^= 16
    write("i/checksum.nii.gz", bytes(damaged))
    refuse("i/checksum.nii.gz", "data: found compressed data that are damaged")
    patched("colours.nii", 70, struct.pack("<hh", 128, 24), "datatype: found 128, expected a scalar type")
    patched("bitpix.nii", 72, struct.pack("<h", 8), "bitpix: found 8, expected 16 of datatype 4")
    patched("unit.nii", 123, b"\7", "xyzt_units: found 7, expected 1, 2 or 3")
    patched("analyze.nii", 344, b"\0\0\0\0", "magic: found none, as ANALYZE 7.5")
    patched("nan.nii", 280, struct.pack("<f", np.nan), "orientation: found nan")
    patched("pixdim.nii", 80, struct.pack("<f", 0.0), "pixdim: found 0, expected a positive length")


def disagreeing(volume, affine):
    image = nifti_image(volume, affine)
    image.set_qform(RAS @ OBLIQUE, 1)
    return image


# ---------------------------------------------------------------- DICOM


def text(values):
    return [("%.10g" % v)[:16] for v in values]


def data_set(pixels, affine, uid=None, bits=16, stored=None, signed=True, sop=CTImageStorage, series="1.2.3.4"):
    """Of one picture, or of frames one behind the other; pixels [row, column] or [frame, row, column]."""
    stored = stored or bits
    d = Dataset()
    d.SOPClassUID, d.SOPInstanceUID, d.Modality = sop, uid or generate_uid(), "CT"
    d.PatientName, d.PatientID = "PHANTOM", "0"
    d.StudyInstanceUID, d.SeriesInstanceUID, d.FrameOfReferenceUID = "1.2.3", series, "1.2.9"
    d.SeriesNumber, d.InstanceNumber = 1, 1
    d.SamplesPerPixel, d.PhotometricInterpretation = 1, "MONOCHROME2"
    d.Rows, d.Columns = pixels.shape[-2:]
    if pixels.ndim == 3:
        d.NumberOfFrames = pixels.shape[0]
    d.BitsAllocated, d.BitsStored, d.HighBit, d.PixelRepresentation = bits, stored, stored - 1, int(signed)
    d.PixelData = pixels.tobytes()
    if len(d.PixelData) % 2:
        d.PixelData += b"\0"
    if affine is not None:
        steps = affine[:3, :3]
        lengths = np.linalg.norm(steps, axis=0)
        d.ImageOrientationPatient = text((steps[:, :2] / lengths[:2]).T.flatten())
        d.ImagePositionPatient = text(affine[:3, 3])
        d.PixelSpacing = text([lengths[1], lengths[0]])
    return d


def save_dicom(name, d, syntax=ExplicitVRLittleEndian, preamble=True):
    d = copy.deepcopy(d)
    if syntax == ExplicitVRBigEndian and d.BitsAllocated > 8:
        d.PixelData = np.frombuffer(d.PixelData, "<u%d" % (d.BitsAllocated // 8)).byteswap().tobytes()
    d["PixelData"].VR = "OB" if d.BitsAllocated <= 8 else "OW"
    meta_ = FileMetaDataset()
    meta_.MediaStorageSOPClassUID, meta_.MediaStorageSOPInstanceUID = d.SOPClassUID, d.SOPInstanceUID
    meta_.TransferSyntaxUID = syntax
    d.is_implicit_VR = syntax == ImplicitVRLittleEndian
    d.is_little_endian = syntax != ExplicitVRBigEndian
    if preamble:
        f = FileDataset(path(name), d, file_meta=meta_, preamble=b"\0" * 128)
        f.is_implicit_VR, f.is_little_endian = d.is_implicit_VR, d.is_little_endian
        f.save_as(path(name), write_like_original=False)
    else:
        pydicom.dcmwrite(path(name), d, write_like_original=True)


def slice_affine(affine, k):
    a = affine.copy()
    a[:3, 3] += a[:3, 2] * k
    return a


def slices(volume, affine, change=None, dtype="<i2", **form):
    """One data set for each slice."""
    result = []
    for k in range(volume.shape[2]):
        d = data_set(np.ascontiguousarray(volume[:, :, k].T.astype(dtype)), slice_affine(affine, k), **form)
        d.InstanceNumber = k + 1
        if change:
            change(d, k)
        result.append(d)
    return result


def save_series(name, sets, **how):
    for k, d in enumerate(sets):
        save_dicom("d/%s/%03d.dcm" % (name, k), d, **how)


def frames(volume, dtype="<i2"):
    return np.ascontiguousarray(np.transpose(volume, (2, 1, 0)).astype(dtype))


def enhanced(volume, affine, order=None, rescale=None):
    order = list(order or range(volume.shape[2]))
    stack = frames(volume)[order]
    d = data_set(stack, None, sop=EnhancedCTImageStorage)
    steps = affine[:3, :3]
    lengths = np.linalg.norm(steps, axis=0)
    shared, orientation, measures = Dataset(), Dataset(), Dataset()
    orientation.ImageOrientationPatient = text((steps[:, :2] / lengths[:2]).T.flatten())
    measures.PixelSpacing = text([lengths[1], lengths[0]])
    measures.SliceThickness = "0.7"
    shared.PlaneOrientationSequence, shared.PixelMeasuresSequence = Sequence([orientation]), Sequence([measures])
    d.SharedFunctionalGroupsSequence = Sequence([shared])
    each = []
    for k in order:
        item, place = Dataset(), Dataset()
        place.ImagePositionPatient = text(slice_affine(affine, k)[:3, 3])
        item.PlanePositionSequence = Sequence([place])
        if rescale:
            values = Dataset()
            values.RescaleSlope, values.RescaleIntercept, values.RescaleType = *rescale(k), "HU"
            item.PixelValueTransformationSequence = Sequence([values])
        each.append(item)
    d.PerFrameFunctionalGroupsSequence = Sequence(each)
    return d


def repack(name, target, syntax):
    """GDCM's encoders."""
    reader = gdcm.ImageReader()
    reader.SetFileName(path(name))
    assert reader.Read(), name
    change = gdcm.ImageChangeTransferSyntax()
    change.SetTransferSyntax(gdcm.TransferSyntax(syntax))
    change.SetInput(reader.GetImage())
    assert change.Change(), (name, syntax)
    writer = gdcm.ImageWriter()
    writer.SetFileName(path(target))
    writer.SetFile(reader.GetFile())
    writer.SetImage(change.GetOutput())
    assert writer.Write(), target


def dicom():
    v, a = PHANTOM, UPRIGHT

    def series(name, volume=v, affine=a, offset=0.0, slope=1.0, change=None, how=None, **form):
        save_series(name, slices(volume, affine, change, **form), **(how or {}))
        read("d/" + name, volume, affine, offset, slope)

    series("axial")
    coronal = turned(v, a, order=(0, 2, 1), flips=(2,))
    sagittal = turned(v, a, order=(1, 2, 0), flips=(2,))
    series("coronal", *coronal)
    series("sagittal", *sagittal)
    series("oblique", v, OBLIQUE)
    series("tilt", v, TILT)
    series("falling", *turned(v, a, flips=(2,)))
    series("left_to_right", *FLIPPED)
    series("implicit", how={"syntax": ImplicitVRLittleEndian})
    series("big_endian", how={"syntax": ExplicitVRBigEndian})
    series("deflated", how={"syntax": DeflatedExplicitVRLittleEndian})
    series("no_preamble", how={"syntax": ImplicitVRLittleEndian, "preamble": False})
    series("unsigned", dtype="<u2", signed=False)
    series("bytes", dtype="u1", bits=8, signed=False)
    series("words_of_32", dtype="<i4", bits=32)
    series("monochrome1", change=lambda d, k: setattr(d, "PhotometricInterpretation", "MONOCHROME1"))

    def rescaled(d, k):
        d.RescaleSlope, d.RescaleIntercept = "500", "-1000"
    series("rescaled", offset=-1000, slope=500, change=rescaled)

    def rescaled_each(d, k):
        stored = np.frombuffer(d.PixelData, "<i2")
        d.PixelData = (stored * 600 // (1 + k % 3)).astype("<i2").tobytes()
        d.RescaleSlope, d.RescaleIntercept = str(1 + k % 3), "-1000"
    series("rescaled_each", offset=-1000, slope=600, change=rescaled_each)

    def twelve_bits(d, k):
        stored = np.frombuffer(d.PixelData, "<i2").astype(int) * 500 - 1000
        overlay = (np.arange(stored.size) % 16) << 12  # bits above those that are stored
        d.PixelData = ((stored & 0xfff) | overlay).astype("<u2").tobytes()
    series("twelve_bits", offset=-1000, slope=500, stored=12, change=twelve_bits)

    random.seed(7)
    names = list(range(SIZE[2]))
    random.shuffle(names)
    for k, d in enumerate(slices(v, a)):
        d.InstanceNumber = names[k] + 1
        save_dicom("d/shuffled/IM%d" % names[(k * 7) % len(names)], d)
    write("d/shuffled/README", "not a slice")
    write("d/shuffled/README.txt", "not a slice")
    write("d/shuffled/Thumbs.db", b"\0" * 512)
    read("d/shuffled")
    report = Dataset()
    report.SOPClassUID, report.SOPInstanceUID = "1.2.840.10008.5.1.4.1.1.88.11", generate_uid()
    report.Modality, report.SeriesInstanceUID = "SR", "1.2.3.99"
    save_series("with_report", slices(v, a))
    meta_ = FileMetaDataset()
    meta_.MediaStorageSOPClassUID, meta_.MediaStorageSOPInstanceUID = report.SOPClassUID, report.SOPInstanceUID
    meta_.TransferSyntaxUID = ExplicitVRLittleEndian
    f = FileDataset(path("d/with_report/report.dcm"), report, file_meta=meta_, preamble=b"\0" * 128)
    f.is_implicit_VR, f.is_little_endian = False, True
    f.save_as(path("d/with_report/report.dcm"), write_like_original=False)
    read("d/with_report")

    scaled = v * 500
    for name, syntax in (("rle", gdcm.TransferSyntax.RLELossless),
                         ("jpeg_57", gdcm.TransferSyntax.JPEGLosslessProcess14),
                         ("jpeg_70", gdcm.TransferSyntax.JPEGLosslessProcess14_1),
                         ("jpeg_ls", gdcm.TransferSyntax.JPEGLSLossless),
                         ("jpeg_2000", gdcm.TransferSyntax.JPEG2000Lossless)):
        for k in range(SIZE[2]):
            d = data_set(np.ascontiguousarray(scaled[:, :, k].T.astype("<u2")), slice_affine(a, k), signed=False)
            save_dicom("plain_of_%s/%d.dcm" % (name, k), d)
            repack("plain_of_%s/%d.dcm" % (name, k), "d/%s/%d.dcm" % (name, k), syntax)
        read("d/" + name, slope=500)

    # DCMTK's encoder: every way to predict a pixel, over values of all sizes.
    noise = np.random.RandomState(5).randint(0, 1 << 15, SIZE) * 2 + 1  # odd: no label's
    noise = data_set(frames(np.where(v > 0, v * 20000, noise), "<u2"), a, signed=False)
    noise.SpacingBetweenSlices = "0.5"
    save_dicom("noise.dcm", noise)
    for predictor in range(1, 8):
        name = "d/predictor_%d.dcm" % predictor
        subprocess.run(["dcmcjpeg", "+el", "+sv", str(predictor), path("noise.dcm"), path(name)], check=True)
        read(name, slope=20000)

    save_dicom("d/enhanced.dcm", enhanced(v, OBLIQUE))
    read("d/enhanced.dcm", v, OBLIQUE)
    interleaved = [*range(0, SIZE[2], 2), *range(1, SIZE[2], 2)]
    save_dicom("d/IM000001", enhanced(v, OBLIQUE))
    read("d/IM000001", v, OBLIQUE)
    save_dicom("d/interleaved.dcm", enhanced(v, a, interleaved))
    read("d/interleaved.dcm")
    save_dicom("d/enhanced_falling.dcm", enhanced(v, a, range(SIZE[2] - 1, -1, -1)))
    read("d/enhanced_falling.dcm")
    save_dicom("d/folder_of_one/falling.dcm", enhanced(v, a, range(SIZE[2] - 1, -1, -1)))
    read("d/folder_of_one")
    save_dicom("d/enhanced_tilt.dcm", enhanced(v, TILT, interleaved))
    read("d/enhanced_tilt.dcm", v, TILT)
    save_dicom("d/enhanced_implicit.dcm", enhanced(v, a, interleaved), ImplicitVRLittleEndian)
    read("d/enhanced_implicit.dcm")
    save_dicom("d/enhanced_big.dcm", enhanced(v, a, interleaved), ExplicitVRBigEndian)
    read("d/enhanced_big.dcm")
    # Stored as labels times 6 over the slope of their frame.
    divided = v * np.array([6 // (1 + k % 3) for k in range(SIZE[2])])
    save_dicom("d/enhanced_rescaled.dcm", enhanced(divided, a, interleaved, lambda k: (1 + k % 3, -100)))
    read("d/enhanced_rescaled.dcm", offset=-100, slope=6)
    packed = enhanced(v, a, interleaved)
    packed.PixelRepresentation = 0
    for name, syntax in (("rle", RLELossless), ("jpeg_70", JPEGLosslessSV1), ("jpeg_ls", JPEGLSLossless),
                         ("jpeg_2000", JPEG2000Lossless)):
        pictures = [next(generate_pixel_data_frame(pydicom.dcmread(path("d/%s/%d.dcm" % (name, k))).PixelData, 1))
                    for k in interleaved]
        for fragments in (1, 3):
            if name == "rle" and fragments > 1:
                continue  # each frame is one
            packed.PixelData = encapsulate(pictures, fragments_per_frame=fragments, has_bot=fragments == 1)
            packed["PixelData"].is_undefined_length = True
            save_dicom("d/enhanced_%s_%d.dcm" % (name, fragments), packed, syntax)
            read("d/enhanced_%s_%d.dcm" % (name, fragments), slope=500)
    for half in (0, 1):
        save_dicom("d/halves/%d.dcm" % half, enhanced(v, a, range(half * 10, half * 10 + 10)))
    read("d/halves")
    dental = data_set(frames(v), a)
    dental.SpacingBetweenSlices = "0.5"
    save_dicom("d/dental.dcm", dental)
    read("d/dental.dcm")
    dose = data_set(frames(v, "<u2"), a, signed=False)
    dose.GridFrameOffsetVector = [str(0.5 * k) for k in range(SIZE[2])]
    dose.DoseGridScaling = "0.25"
    save_dicom("d/dose.dcm", dose)
    read("d/dose.dcm", slope=0.25)

    no_spacing = slices(v, a)
    for d in no_spacing:
        del d.PixelSpacing
    save_series("no_pixel_spacing", no_spacing)
    ask("d/no_pixel_spacing", affine=a)
    no_place = slices(v, a)
    for d in no_place:
        del d.ImagePositionPatient
    save_series("no_position", reversed(no_place))
    ask("d/no_position")
    alone = data_set(frames(v), a)
    save_dicom("d/frames_at_one_place.dcm", alone)
    ask("d/frames_at_one_place.dcm")
    nothing = data_set(frames(v), None)
    save_dicom("d/secondary.dcm", nothing)
    ask("d/secondary.dcm")

    some = slices(v, a)
    save_series("three_absent", some[:7] + some[10:])
    refuse("d/three_absent", "ImagePositionPatient: found 2 mm between 006.dcm and 007.dcm, at 103 and 105 mm")
    save_series("one_twice", some + [copy.deepcopy(some[5])])
    refuse("d/one_twice", "ImagePositionPatient: found 005.dcm and 020.dcm at one place")
    stretched = slices(v, a, lambda d, k: setattr(d, "ImagePositionPatient", text(
        (-10, 5, 100 + 0.5 * k + max(0, k - 12) * 0.25))))
    save_series("two_steps", stretched)
    refuse("d/two_steps", "ImagePositionPatient: found 0.75 mm between 012.dcm and 013.dcm")
    save_series("beside", slices(v, a, lambda d, k: setattr(d, "ImagePositionPatient", text(
        (-10 + (0.3 if k == 9 else 0), 5, 100 + 0.5 * k)))))
    refuse("d/beside", "009.dcm 0.28")
    # Positions of one digit behind the point, as some write them.
    rounded = lattice(spacing=(0.3, 0.4, 0.625))
    save_series("rounded", slices(v, rounded, lambda d, k: setattr(d, "ImagePositionPatient", [
        "%.1f" % x for x in slice_affine(rounded, k)[:3, 3]])))
    read("d/rounded", v, rounded)
    save_series("two_series", slices(v, a)[:10] + slices(v, a, series="1.2.3.5")[10:])
    refuse("d/two_series", "SeriesInstanceUID: found 2 DICOM series, expected one")
    localizer = data_set(np.zeros((30, 40), "<i2"), coronal[1])
    save_series("with_localizer", slices(v, a) + [localizer])
    refuse("d/with_localizer", "ImageOrientationPatient: found another than of the first frame")
    whole = slices(v, a)
    save_series("cut_slice", whole)
    end = open(path("d/cut_slice/004.dcm"), "rb").read()
    write("d/cut_slice/004.dcm", end[:-100])
    refuse("d/cut_slice", "004.dcm: PixelData: found 2300 bytes")
    save_series("no_slice", whole)
    write("d/no_slice/006.dcm", b"garbage" * 500)
    refuse("d/no_slice", "006.dcm: header: found contents that cannot be one")
    fewer = data_set(frames(v), a)
    fewer.NumberOfFrames, fewer.SpacingBetweenSlices = 25, "0.5"
    save_dicom("d/frames.dcm", fewer)
    refuse("d/frames.dcm", "PixelData: found 48000 bytes, expected 60000")
    more = enhanced(v, a)
    more.PerFrameFunctionalGroupsSequence.pop()
    save_dicom("d/groups.dcm", more)
    refuse("d/groups.dcm", "NumberOfFrames: found 20, expected 19")
    colours = data_set(np.zeros((30, 120), "u1"), a, bits=8, signed=False)
    colours.SamplesPerPixel, colours.PhotometricInterpretation, colours.PlanarConfiguration = 3, "RGB", 0
    colours.Columns = 40
    save_dicom("d/colours.dcm", colours)
    refuse("d/colours.dcm", "PhotometricInterpretation: found RGB of 3 samples")
    for name in ("jpeg_57", "jpeg_ls", "jpeg_2000", "rle"):
        packed = bytearray(open(path("d/%s/5.dcm" % name), "rb").read())
        middle = packed.find(b"\xe0\x7f\x10\x00") + 60
        packed[middle:] = packed[middle:middle + 20] + b"\0" * (len(packed) - middle - 28) + packed[-8:]
        write("d/damaged_%s/5.dcm" % name, bytes(packed))
        refuse("d/damaged_" + name, "5.dcm: PixelData")


# ---------------------------------------------------------------- TIFF and PNG


def tiff():
    v = PHANTOM
    stack = frames(v, "u2")
    resolution = (1 / 0.3, 1 / 0.4)
    at_0 = lattice(origin=(0, 0, 0))

    def image_j(name, **how):
        tifffile.imwrite(path("t/" + name), stack, imagej=True, **how)
        read("t/" + name, v, at_0)

    def ome(name, data=stack, **how):
        tifffile.imwrite(path("t/" + name), data, ome=True, metadata={
            "axes": "ZYX", "PhysicalSizeX": 300.0, "PhysicalSizeXUnit": "µm", "PhysicalSizeY": 0.4,
            "PhysicalSizeYUnit": "mm", "PhysicalSizeZ": 500.0}, **how)
        read("t/" + name, v, at_0)

    image_j("image_j.tif", resolution=resolution, metadata={"spacing": 0.5, "unit": "mm", "axes": "ZYX"})
    image_j("image_j_um.tif", resolution=(1 / 300, 1 / 400), metadata={"spacing": 500, "unit": "um", "axes": "ZYX"})
    ome("plain.ome.tif")
    ome("big.ome.tif", bigtiff=True)
    ome("big_endian.ome.tif", byteorder=">")
    ome("tiles.ome.tif", tile=(16, 32))
    ome("deflated.ome.tif", compression="zlib")
    ome("deflated_tiles.ome.tif", compression="zlib", tile=(16, 16))
    ome("float.ome.tif", frames(v, "f4"))
    ome("double.ome.tif", frames(v, "f8"))
    ome("bytes.ome.tif", frames(v, "u1"))
    ome("signed.ome.tif", frames(v, "i2"))
    ome("words_of_32.ome.tif", frames(v, "u4"))
    ome("white_is_zero.ome.tif", photometric="miniswhite")

    def asked(name, write_it, volume=v, **more):
        write_it()
        ask(name, volume, **more)

    asked("t/plain.tif", lambda: tifffile.imwrite(path("t/plain.tif"), stack))
    asked("t/print.tif", lambda: tifffile.imwrite(path("t/print.tif"), stack, resolution=(300, 300),
                                                  resolutionunit="INCH"))

    # Turned pages, by the tag alone: 2 to 8 as each of them is stored.
    pages = {1: stack, 2: stack[:, :, ::-1], 3: stack[:, ::-1, ::-1], 4: stack[:, ::-1],
             5: stack.transpose(0, 2, 1), 6: stack.transpose(0, 2, 1)[:, ::-1],
             7: stack.transpose(0, 2, 1)[:, ::-1, ::-1], 8: stack.transpose(0, 2, 1)[:, :, ::-1]}
    for orientation, stored in pages.items():
        name = "t/orientation_%d.tif" % orientation
        with tifffile.TiffWriter(path(name)) as f:
            for page in stored:
                f.write(page, contiguous=False, metadata=None,
                        extratags=[(274, "H", 1, orientation, True)])
        ask(name)

    def folder(name, number, extension="tif", order=range(SIZE[2]), volume=v):
        for k in order:
            file = path("t/%s/%s.%s" % (name, number(k), extension))
            if extension == "tif":
                tifffile.imwrite(file, stack[k])
            else:
                Image.fromarray(stack[k].astype(np.uint16)).save(file)
        ask("t/" + name, volume)

    folder("tiffs", lambda k: "slice_%d" % (k + 1))
    folder("pngs", lambda k: "slice_%d" % (k + 1), "png")
    folder("decimals", lambda k: "slice_%g" % (0.25 * (k + 1)))
    folder("signed_decimals", lambda k: "z_%g" % (0.5 * (k - 10)), "png")
    folder("gap", lambda k: "slice_%d" % (k + 1), "png", [k for k in range(SIZE[2]) if k != 9],
           np.delete(v, 9, axis=2))
    for k in range(SIZE[2]):
        file = path("t/bits/%02d.png" % k)
        Image.fromarray(stack[k] == 1).save(file)  # one bit a pixel
    mask = (v == 1).astype(int)
    TRUTH.append("ask t/bits 0 1 0.3 0.4 0.5 %s" % (places(np.where(v == 1, 1, 0) + 2 * (v == 99), at_0)
                                                    if mask.sum() == 0 else one_label(mask, at_0)))

    whole = open(path("t/plain.tif"), "rb").read()
    write("t/cut.tif", whole[:-9000])
    refuse("t/cut.tif", "found")
    tifffile.imwrite(path("t/colours.tif"), np.zeros((4, 30, 40, 3), np.uint8), photometric="rgb")
    refuse("t/colours.tif", "page 0: found colours")
    tifffile.imwrite(path("t/channels.tif"), np.zeros((5, 2, 30, 40), np.uint16), imagej=True,
                     metadata={"axes": "ZCYX", "spacing": 0.5, "unit": "mm"}, resolution=resolution)
    refuse("t/channels.tif", "ImageDescription: found several channels")
    for k in (1, 2, 3):
        tifffile.imwrite(path("t/twice/slice_%d.tif" % k), stack[k])
    tifffile.imwrite(path("t/twice/slice_02.tif"), stack[5])
    refuse("t/twice", "slice_02.tif and slice_2.tif, expected each number once")
    for name in ("slice_1", "slice_2", "preview"):
        tifffile.imwrite(path("t/stray/%s.tif" % name), stack[3])
    refuse("t/stray", "expected names that differ in their numbers alone")
    for k in (1, 2, 3):
        Image.fromarray(stack[k].astype(np.uint16)).save(path("t/damaged/%d.png" % k))
    bad = bytearray(open(path("t/damaged/2.png"), "rb").read())
    bad[-30] ^= 255
    write("t/damaged/2.png", bytes(bad))
    refuse("t/damaged", "2.png: data: found pixels that cannot be read")
    tifffile.imwrite(path("t/mixed/slice_1.tif"), stack[1])
    Image.fromarray(stack[1].astype(np.uint16)).save(path("t/mixed/slice_2.png"))
    refuse("t/mixed", "slices of more than one of TIFF, PNG and DICOM")


def one_label(volume, affine):
    index = np.argwhere(volume == 1)
    middle = affine @ np.append(index.mean(axis=0), 1.0)
    numbers = [*middle[:3], len(index) * abs(np.linalg.det(affine[:3, :3]))]
    return " ".join("%.9g" % n for n in numbers) + " 0 0 0 0" * 2


nrrd()
meta_image()
nifti()
dicom()
tiff()
with open(path("truth.txt"), "w") as truth:
    truth.write("\n".join(TRUTH) + "\n")
