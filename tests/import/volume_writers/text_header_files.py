"""NRRD and MetaImage: the bytes themselves."""

import bz2
import gzip
import zlib

import numpy as np

from phantom import *


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
