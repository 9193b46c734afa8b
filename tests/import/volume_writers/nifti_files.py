"""NIfTI, by nibabel."""

import struct

import nibabel
import numpy as np

from phantom import *


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
