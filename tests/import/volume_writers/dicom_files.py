"""DICOM, by pydicom, GDCM and DCMTK."""

import copy
import os
import random
import subprocess

import gdcm
import numpy as np
import pydicom
from pydicom.dataset import Dataset, FileDataset, FileMetaDataset
from pydicom.sequence import Sequence
from pydicom.encaps import encapsulate, generate_pixel_data_frame
from pydicom.uid import (CTImageStorage, DeflatedExplicitVRLittleEndian, EnhancedCTImageStorage,
                         ExplicitVRBigEndian, ExplicitVRLittleEndian, ImplicitVRLittleEndian,
                         JPEG2000Lossless, JPEGLosslessSV1, JPEGLSLossless, RLELossless, generate_uid)

from phantom import *

gdcm.Trace.WarningOff()
gdcm.Trace.ErrorOff()


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
