#!/usr/bin/env python3
"""Memory and time of building bones from a CT of a whole body, beside those of building them from CTs cut down to each.

Makes a CT of 512 x 512 x 900 voxels (0.875 x 0.875 x 1 mm) with a label map of a hundred labels out of the phantoms of `bonetk phantom`, the
bones of BONETK_DATA, vertebrae, ribs and soft tissue, with noise; builds its bones from each format; and writes
Documentation/validation/wholebody.md. Environment: BONETK (the program), BONETK_DATA (folder of data).

    BONETK=build/test/Apps/bonetk/bonetk Testing/Validation/wholebody.py
"""
import argparse
import os
import pathlib
import subprocess
import tempfile
import zlib

import nibabel
import numpy

from report import made_by

ROOT = pathlib.Path(__file__).resolve().parents[2]
DATA = pathlib.Path(os.environ["BONETK_DATA"])
SIZE = (512, 512, 900)
SPACING = numpy.array((0.875, 0.875, 1.0))  # all formats hold them exactly
MARGIN = (12, 12, 10)  # that of `build`, 10 mm, in voxels
TETRAHEDRA = 1500
BONES = ["hip_right", "vertebra_L3", "rib_right_6"]
NOISE = 20.0
FORMATS = ("nii.gz", "nii", "mha", "mhd", "compressed mha", "nrrd")


class Body:
    """CT, label map and names."""

    def __init__(self):
        self.random = numpy.random.default_rng(30)
        x, y = numpy.meshgrid(numpy.arange(SIZE[0]), numpy.arange(SIZE[1]), indexing="ij")
        inside = ((x - 256) / 250.0) ** 2 + ((y - 256) / 220.0) ** 2 < 1
        self.ct = numpy.empty(SIZE, numpy.int16, "F")
        self.ct[:] = numpy.where(inside, 40, -1000).astype(numpy.int16)[:, :, None]
        self.labels = numpy.zeros(SIZE, numpy.uint8, "F")
        self.names = []

    def paste(self, name, ct, mask, at):
        """A bone, and what is around it within two voxels."""
        box = tuple(slice(a, a + n) for a, n in zip(at, mask.shape))
        around = mask.copy()
        for axis in range(3):
            around = around | numpy.roll(around, 2, axis) | numpy.roll(around, -2, axis)
        labels = self.labels[box]
        assert labels.shape == mask.shape and not (labels[mask] > 0).any(), name
        around &= labels == 0
        self.ct[box][around] = ct[around]
        self.names.append(name)
        labels[mask] = len(self.names)

    def add_noise(self):
        for k in range(SIZE[2]):
            self.ct[:, :, k] += self.random.normal(0, NOISE, SIZE[:2]).round().astype(numpy.int16)


def resample(image, spacing, linear):
    """To the body's spacing along x and y; along z it has that."""
    for axis in (0, 1):
        n = int((image.shape[axis] - 1) * spacing / SPACING[axis])
        at = numpy.arange(n) * SPACING[axis] / spacing
        low = numpy.floor(at).astype(int)
        part = (at - low).reshape([-1 if d == axis else 1 for d in range(3)])
        a, b = image.take(low, axis), image.take(low + 1, axis)
        image = a + (b - a) * part if linear else numpy.where(part < 0.5, a, b)
    return image


def real(name, label):
    """A bone of BONETK_DATA."""
    ct, labels = (nibabel.load(DATA / f"{name}_ct" / f"{name}_{kind}.nii.gz") for kind in ("ct", "labels"))
    spacing = float(ct.header.get_zooms()[0])
    return resample(ct.get_fdata(dtype=numpy.float32), spacing, True), resample(numpy.asarray(labels.dataobj) == label, spacing, False)


def phantom(bone, folder):
    ct, labels = folder / f"{bone}.nii.gz", folder / f"{bone}_l.nii.gz"
    measure("phantom", "--bone", bone, "--spacing", SPACING[0], "--slice-spacing", SPACING[2], "-o", ct, "--labels", labels)
    return nibabel.load(ct).get_fdata(dtype=numpy.float32), numpy.asarray(nibabel.load(labels).dataobj) > 0


def layered(depth):
    """Density of a bone with a cortex of 1.5 mm, of the depth below its surface in mm."""
    return numpy.clip(40 + 900 * (depth + 0.5), 40, 1200) - 850 * numpy.clip(depth - 1.5, 0, 1)


def vertebra():
    x, y, z = numpy.meshgrid(*(numpy.arange(-n, n + 1) * s for n, s in zip((28, 22, 9), SPACING)), indexing="ij")
    radius = ((numpy.hypot(x / 22, y / 16)) ** 4 + (z / 7) ** 4) ** 0.25
    depth = (1 - radius) * 10
    return layered(depth), depth > 0


def rib(side):
    """A tube of 6 mm about half an ellipse that slopes down by 90 mm."""
    size = numpy.array((160, 230, 115))
    depth = numpy.full(size, -6.0)
    for angle in numpy.linspace(0.1, 2.6, 800):
        centre = numpy.array((8 + 120 * numpy.sin(angle), 100 + 90 * numpy.cos(angle), 100 - 90 * angle / 2.6))
        low = numpy.round(centre / SPACING).astype(int) - 9
        low = numpy.maximum(low, 0)
        box = tuple(slice(a, a + 19) for a in low)
        grid = numpy.meshgrid(*((numpy.arange(a, min(a + 19, n)) * s - c) for a, n, s, c in zip(low, size, SPACING, centre)), indexing="ij")
        depth[box] = numpy.maximum(depth[box], 6 - numpy.sqrt(sum(g * g for g in grid)))
    depth = depth if side == "left" else depth[::-1]
    return layered(depth), depth > 0


def make_body(folder):
    body = Body()
    femur, hemipelvis = phantom("femur", folder), phantom("hemipelvis", folder)
    body.paste("femur_right", *femur, (10, 180, 5))
    body.paste("femur_left", *(part[::-1] for part in femur), (500 - femur[0].shape[0], 180, 5))
    body.paste("hip_right", *real("hip", 2), (90, 290, 225))
    body.paste("hip_left", *(part[::-1] for part in hemipelvis), (430 - hemipelvis[0].shape[0], 290, 225))
    for side, at in (("right", 120), ("left", 250)):
        for name, label in (("tibia", 2), ("fibula", 4)):
            bone = real("tibia", label)
            body.paste(f"{name}_{side}", *(part[::-1] if side == "left" else part for part in bone), (at, 60, 5))
    shape = vertebra()
    for i, name in enumerate([f"L{k}" for k in range(5, 0, -1)] + [f"T{k}" for k in range(12, 0, -1)] + [f"C{k}" for k in range(7, 0, -1)]):
        body.paste(f"vertebra_{name}", *shape, (256 - 28, 380, 480 + 17 * i))
    for side in ("left", "right"):
        shape = rib(side)
        for i in range(12):
            body.paste(f"rib_{side}_{12 - i}", *shape, (256 if side == "left" else 256 - 160, 140, 480 + 25 * i))
    ball = numpy.hypot(*numpy.meshgrid(*(numpy.arange(-8, 9),) * 2, indexing="ij"))[:, :, None] + abs(numpy.arange(-8, 9)) < 9
    for i in range(100 - len(body.names)):
        body.paste(f"soft_{i + 1}", numpy.full(ball.shape, 60.0), ball, (150 + 20 * (i % 10), 100, 500 + 20 * (i // 10)))
    body.add_noise()
    return body


def meta_header(data, element, extra=""):
    return (f"ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n{extra}"
            f"TransformMatrix = 1 0 0 0 1 0 0 0 1\nOffset = 0 0 0\nElementSpacing = {' '.join(map(str, SPACING))}\n"
            f"DimSize = {' '.join(map(str, SIZE))}\nElementType = {element}\nElementDataFile = {data}\n").encode()


def write(image, kind, path, origin=(0, 0, 0)):
    """The image as a file of this kind, with its first voxel at an index of the body; its name."""
    bytes_of = image.tobytes("F")
    element = "MET_SHORT" if image.dtype == numpy.int16 else "MET_UCHAR"
    path = path.with_name(f"{path.name}.{kind.split()[-1]}")
    if kind in ("nii", "nii.gz"):
        affine = numpy.diag((*(-SPACING[:2]), SPACING[2], 1))
        affine[:3, 3] = affine[:3, :3] @ origin
        nibabel.save(nibabel.Nifti1Image(image, affine), path)
    elif kind == "mha":
        path.write_bytes(meta_header("LOCAL", element) + bytes_of)
    elif kind == "mhd":
        path.with_suffix(".raw").write_bytes(bytes_of)
        path.write_bytes(meta_header(path.with_suffix(".raw").name, element))
    elif kind == "compressed mha":
        packed = zlib.compress(bytes_of, 2)
        path.write_bytes(meta_header("LOCAL", element, f"CompressedData = True\nCompressedDataSize = {len(packed)}\n") + packed)
    else:
        packer = zlib.compressobj(2, wbits=31)
        x, y, z = SPACING
        path.write_bytes((f"NRRD0004\ntype: {'short' if element == 'MET_SHORT' else 'unsigned char'}\ndimension: 3\nspace: "
                          f"left-posterior-superior\nsizes: {' '.join(map(str, SIZE))}\nspace directions: ({x},0,0) (0,{y},0) (0,0,{z})\n"
                          "kinds: domain domain domain\nendian: little\nencoding: gzip\nspace origin: (0,0,0)\n\n").encode() +
                         packer.compress(bytes_of) + packer.flush())
    return path


class Cost:
    """Seconds by the clock and of the processors, and the peak in MB; of several runs the sums and the largest peak."""

    def __init__(self, wall=0.0, processor=0.0, peak=0.0):
        self.wall, self.processor, self.peak = wall, processor, peak

    def __add__(self, other):
        return Cost(self.wall + other.wall, self.processor + other.processor, max(self.peak, other.peak))


def measure(*arguments):
    """Runs the program. Through `time`, as the peak of a process begins with that of the one that starts it."""
    with tempfile.NamedTemporaryFile("r") as cost:
        subprocess.run(["/usr/bin/time", "-f", "%e %U %S %M", "-o", cost.name, os.environ["BONETK"], *map(str, arguments), "--quiet"],
                       check=True, stderr=subprocess.PIPE)
        wall, user, system, peak = map(float, cost.read().split())
    return Cost(wall, user + system, peak / 1024)


def models(folder):
    """The bytes of a bone's models."""
    return b"".join(file.read_bytes() for file in sorted(folder.glob("model_L*.vtu")))


class Measurement:
    """Of whole bodies in all formats beside cut-down CTs."""

    def __init__(self, body, folder):
        self.body, self.folder = body, folder
        self.names = folder / "names.csv"
        self.names.write_text("".join(f"{i},{name}\n" for i, name in enumerate(body.names, 1)))
        self.cropped = {}
        self.bytes = {}

    def crop(self, bone, tetrahedra):
        """What building it from a CT of its own costs."""
        if (bone, tetrahedra) not in self.cropped:
            label = self.body.names.index(bone) + 1
            at = numpy.argwhere(self.body.labels == label)
            low = numpy.maximum(at.min(0) - MARGIN, 0)
            box = tuple(slice(a, b) for a, b in zip(low, at.max(0) + MARGIN + 1))
            del at
            files = [write(image[box], "nii.gz", self.folder / name, low)
                     for image, name in ((self.body.ct, "ct_cropped"), (self.body.labels, "labels_cropped"))]
            out = self.folder / "cropped"
            self.cropped[bone, tetrahedra] = measure("build", files[0], "--labels", files[1], "--label", label, "--tetrahedra",
                                                     tetrahedra, "--force", "-o", out)
            self.bytes[bone, tetrahedra] = models(out)
        return self.cropped[bone, tetrahedra]

    def row(self, kind, bones, tetrahedra, title):
        """Builds the bones in one run; a line of the table."""
        ct, labels = (write(image, kind, self.folder / name) for image, name in ((self.body.ct, "ct"), (self.body.labels, "labels")))
        out = self.folder / "whole"
        cost = measure("build", ct, "--labels", labels, "--label-names", self.names, "--label", ",".join(bones), "--tetrahedra",
                       tetrahedra, "--force", "-o", out)
        for file in (ct, labels):
            file.unlink()
            file.with_suffix(".raw").unlink(missing_ok=True)
        alone = sum((self.crop(bone, tetrahedra) for bone in bones), Cost())
        same = sum(models(out if len(bones) == 1 else out / bone) == self.bytes[bone, tetrahedra] for bone in bones)
        return (f"| {title} | {cost.peak:.0f} | {alone.peak:.0f} | {cost.wall:.1f} | {alone.wall:.1f} | {cost.wall / alone.wall:.2f} | "
                f"{cost.processor / alone.processor:.2f} | {same} of {len(bones)} |")


PAGE = """# Bones of a whole body's CT

{made_by}.

A CT of 512 × 512 × 900 voxels of 0.875 × 0.875 × 1 mm (short, noise of {noise:.0f} HU) with a label map of a hundred labels (unsigned char): femur
and hemipelvis of `bonetk phantom`, bones of two CTs, 24 vertebrae, 24 ribs, and soft tissue. As float the CT alone takes 944 MB. `bonetk
build` makes bones of it in one run. Beside it stands what these bones cost where each is built in a run of its own from a CT and a
label map that were cut down to it and the margin of 10 mm: the sum of the seconds, and the largest peak. Models are compared byte for
byte. Of a compressed file all has to be decompressed once, whatever is built.
"""
SECTION = """
## {}

{}

| {} | peak, MB | peak of cropped ones, MB | seconds | of cropped ones | ratio | ratio of processor time | same models |
|---|---|---|---|---|---|---|---|
"""


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.parse_args()
    page = ROOT / "Documentation/validation/wholebody.md"
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        body = make_body(folder)
        bones = [bone for bone in body.names if not bone.startswith("soft_")]
        measurement = Measurement(body, folder)
        text = PAGE.format(made_by=made_by(__file__), noise=NOISE)
        text += SECTION.format("Formats", f"{', '.join(BONES)} in one run, of {TETRAHEDRA:,} tetrahedra. CT and label map have the format.", "format")
        for kind in FORMATS:
            text += measurement.row(kind, BONES, TETRAHEDRA, kind) + "\n"
        page.write_text(text)
        text += SECTION.format("All bones in one run", f"From .nii.gz, of {TETRAHEDRA:,} tetrahedra each: all labels that are no soft tissue.",
                               "built")
        text += measurement.row("nii.gz", bones, TETRAHEDRA, f"{len(bones)} bones") + "\n"
        page.write_text(text)
        text += SECTION.format("One bone", "From .nii.gz, of 33,000 tetrahedra.", "bone")
        text += measurement.row("nii.gz", ["hip_right"], 33000, "hip_right") + "\n"
        page.write_text(text)


if __name__ == "__main__":
    main()
