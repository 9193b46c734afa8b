"""TIFF and PNG, by tifffile and Pillow."""

import numpy as np
import tifffile
from PIL import Image

from phantom import *


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
