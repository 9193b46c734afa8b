"""Writes one phantom in more than a hundred ways, and what a reader should make of each.

    write_volumes.py FOLDER

The writers are not those of the program under test: pydicom, nibabel, tifffile, Pillow, GDCM and DCMTK for
what DICOM packs pixels by, and for NRRD and MetaImage the bytes themselves. FOLDER/truth.txt has a line for
each file or folder of slices:

    read NAME OFFSET SLOPE then for labels 1 to 3: x y z mm3     grey = OFFSET + SLOPE * label
    ask NAME OFFSET SLOPE dx dy dz then the same                 the file does not say its spacing
    refuse NAME TEXT                                             what the line must hold
"""

import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "volume_writers"))

from dicom_files import dicom
from nifti_files import nifti
from phantom import TRUTH, path
from text_header_files import meta_image, nrrd
from tiff_png_files import tiff

nrrd()
meta_image()
nifti()
dicom()
tiff()
with open(path("truth.txt"), "w") as truth:
    truth.write("\n".join(TRUTH) + "\n")
