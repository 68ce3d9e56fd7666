#!/usr/bin/env python3
"""Which bone, which series, which grid: what real files hold, and that the right part of it is taken."""
import json
import os

import nibabel
import numpy
import pydicom
from pydicom.dataset import FileDataset, FileMetaDataset
from pydicom.uid import CTImageStorage, ExplicitVRLittleEndian, generate_uid

from bonetk_testing import TestCase, bonetk, main, read_json, write_image

SIZE = (40, 36, 30)
SPACING = (1.5, 1.5, 2.0)
SMALL = ["--tetrahedra", "800", "--levels", "0.5"]
TABLE = ('<?xml version="1.0" encoding="UTF-8"?><CaretExtension><VolumeInformation Index="0"><LabelTable>'
         '<Label Key="25" Red="1" Green="0" Blue="0" Alpha="1"><![CDATA[femur_left]]></Label>'
         '<Label Key="26" Red="1" Green="1" Blue="0" Alpha="1">femur_right</Label>'
         '</LabelTable></VolumeInformation></CaretExtension>')


def two_bones():
    """Two cylinders: CT, and label map with 25 and 26."""
    x, y, z = numpy.meshgrid(*[numpy.arange(n) for n in SIZE], indexing="ij")
    inside = (z > 2) & (z < 27)

    def cylinder(at, radius):
        return ((x - at) ** 2 + (y - 17) ** 2 < radius ** 2) & inside

    labels = numpy.zeros(SIZE, numpy.uint8)
    labels[cylinder(12, 8)] = 25
    labels[cylinder(29, 7)] = 26
    ct = numpy.where(labels > 0, 700, -50).astype(numpy.int16)
    ct[cylinder(12, 5) | cylinder(29, 4)] = 200
    return ct, labels


def write_segments(path, layers, segments):
    """A .seg.nrrd of 3D Slicer: arrays, one a layer, and (name, layer, value) of each segment."""
    several = len(layers) > 1
    header = ["NRRD0004", "type: unsigned char", f"dimension: {4 if several else 3}", "space: left-posterior-superior",
              "sizes: " + (f"{len(layers)} " if several else "") + " ".join(str(n) for n in SIZE),
              "space directions: " + ("none " if several else "") + "(-1.5,0,0) (0,-1.5,0) (0,0,2)",
              "kinds: " + ("list " if several else "") + "domain domain domain", "encoding: raw",
              "space origin: (0,0,0)"]
    for i, (name, layer, value) in enumerate(segments):
        header += [f"Segment{i}_ID:=Segment_{i}", f"Segment{i}_Name:={name}", f"Segment{i}_Layer:={layer}",
                   f"Segment{i}_LabelValue:={value}"]
    voxels = numpy.stack(layers) if several else layers[0]
    with open(path, "wb") as file:
        file.write("\n".join(header).encode() + b"\n\n" + voxels.astype(numpy.uint8).tobytes(order="F"))


def write_slice(path, voxels, height, series, number=3, description="Bone", kind="ORIGINAL\\PRIMARY\\AXIAL", uid=None):
    meta = FileMetaDataset()
    meta.MediaStorageSOPClassUID = CTImageStorage
    meta.MediaStorageSOPInstanceUID = uid or generate_uid()
    meta.TransferSyntaxUID = ExplicitVRLittleEndian
    data = FileDataset(path, {}, file_meta=meta, preamble=b"\0" * 128)
    data.is_little_endian, data.is_implicit_VR = True, False
    data.SOPClassUID, data.SOPInstanceUID = CTImageStorage, meta.MediaStorageSOPInstanceUID
    data.SeriesInstanceUID, data.SeriesNumber, data.SeriesDescription = series, number, description
    data.StudyInstanceUID, data.FrameOfReferenceUID = "1.2.3", "1.2.3.4"
    data.Modality, data.ImageType = "CT", kind
    data.ImagePositionPatient, data.ImageOrientationPatient = [0, 0, height], [1, 0, 0, 0, 1, 0]
    data.PixelSpacing, data.SliceThickness, data.InstanceNumber = [1.5, 1.5], 2, 1
    data.Rows, data.Columns = voxels.shape[1], voxels.shape[0]
    data.SamplesPerPixel, data.PhotometricInterpretation = 1, "MONOCHROME2"
    data.BitsAllocated, data.BitsStored, data.HighBit, data.PixelRepresentation = 16, 16, 15, 1
    data.RescaleIntercept, data.RescaleSlope = 0, 1
    data.PixelData = voxels.T.astype(numpy.int16).tobytes()
    data.save_as(path)


class Labels(TestCase):
    def setUp(self):
        super().setUp()
        self.ct, self.labels = two_bones()
        write_image("ct.nii.gz", self.ct, SPACING)
        write_image("labels.nii.gz", self.labels, SPACING)

    def volume(self, *options):
        """Voxels that `crop` takes for the bone."""
        self.succeed("crop", "ct.nii.gz", "-o", "crop.nii.gz", "--write-labels", "crop_labels.nii.gz", *options)
        return nibabel.load("crop_labels.nii.gz").get_fdata()

    def test_which_of_several_labels(self):
        count = [int((self.labels == value).sum()) for value in (25, 26)]
        for command in (["build", "ct.nii.gz", "-o", "out"], ["crop", "ct.nii.gz", "-o", "o.mha"],
                        ["contours", "ct.nii.gz", "-o", "o.vtp"]):
            error = self.refuse_usage(*command, "--labels", "labels.nii.gz", says="--label")
            self.assertIn(f"25 ({count[0]} voxels, {4.5e-3 * count[0]:.1f} cm^3), 26 ({count[1]} voxels", error)
            self.refuse(*command, "--labels", "labels.nii.gz", "--label", "9", says="no label 9; it has 25 (")
            self.refuse(*command, "--labels", "labels.nii.gz", "--label", "2x5", says="no label 2x5")
        self.succeed("crop", "ct.nii.gz", "--labels", "labels.nii.gz", "--label", "025", "-o", "o.mha")

    def test_names_of_labels(self):
        image = nibabel.Nifti1Image(self.labels, numpy.diag(list(SPACING) + [1.0]))
        image.header.extensions.append(nibabel.nifti1.Nifti1Extension(0, TABLE.encode()))
        nibabel.save(image, "named.nii.gz")
        write_segments("slicer.seg.nrrd", [self.labels], [("Femur left", 0, 25), ("Femur right", 0, 26)])
        tables = {"comma.csv": "value,name\n25,left femur\n26,right femur\n",
                  "slicer.ctbl": "# Slicer\n0 background 0 0 0 0\n25 left 128 174 128 255\n26 right 1 2 3 255\n",
                  "snap.txt": '0 0 0 0 0 0 0 "Clear Label"\n25 255 0 0 1 1 1 "left femur"\n26 0 255 0 1 1 1 "right"\n',
                  "bars.txt": "|Index|Name|\n|:-:|:-:|\n|25|left|\n|26|right|\n",
                  "by_value.json": '{"25": "left", "26": "right"}',
                  "by_name.json": '{"labels": {"background": 0, "left": 25, "right": 26}}'}
        for name, text in tables.items():
            with open(name, "w") as file:
                file.write(text)
        for says, options in (("femur_left", ["named.nii.gz"]), ("Femur left", ["slicer.seg.nrrd"])):
            out, _ = self.succeed("info", options[0])
            self.assertIn(says, out)
            error = self.refuse_usage("crop", "ct.nii.gz", "-o", "o.mha", "--labels", *options, says="--label")
            self.assertIn(f"25 '{says}' (", error)
        for file, left in (("named.nii.gz", "femur_left"), ("named.nii.gz", "FEMUR_LEFT"),
                           ("slicer.seg.nrrd", "Femur left")):
            kept = self.volume("--labels", file, "--label", left)
            self.assertEqual((kept == 25).sum(), (self.labels == 25).sum())
        for table, left in (("comma.csv", "left femur"), ("slicer.ctbl", "left"), ("snap.txt", "left femur"),
                            ("bars.txt", "left"), ("by_value.json", "left"), ("by_name.json", "left")):
            kept = self.volume("--labels", "labels.nii.gz", "--label-names", table, "--label", left)
            self.assertEqual((kept == 25).sum(), (self.labels == 25).sum(), table)
        for name, text in (("none.csv", "no table\nat all\nin it\nnone\n"), ("list.json", "[1, 2]"),
                           ("odd.json", '{"a": "b"}'), ("late.csv", "25,left\nright,26\n"), ("empty.csv", "")):
            with open(name, "w") as file:
                file.write(text)
            self.refuse("crop", "ct.nii.gz", "-o", "o.mha", "--labels", "labels.nii.gz", "--label-names", name,
                        says=name)

    def test_overlapping_segments(self):
        left, both = self.labels == 25, self.labels > 0
        write_segments("two.seg.nrrd", [left, both], [("Left", 0, 1), ("Both", 1, 1)])
        out, _ = self.succeed("info", "two.seg.nrrd")
        self.assertIn("2 layers", out)
        self.assertEqual(self.volume("--labels", "two.seg.nrrd", "--label", "Both").sum(), both.sum())
        self.assertEqual(self.volume("--labels", "two.seg.nrrd", "--label", "Left").sum(), left.sum())
        command = ["crop", "ct.nii.gz", "-o", "o.mha", "--labels", "two.seg.nrrd"]
        self.refuse(*command, "--label", "1", says="2 are called 1")
        self.refuse_usage(*command, says="1 'Left' (")
        self.refuse("drr", "ct.nii.gz", "--mask", "two.seg.nrrd", "--geometry", self.view(), "-o", "o.mha",
                    says="2 layers")

    def view(self):
        with open("view.json", "w") as file:
            json.dump({"source": [0, -1000, 30], "detectorOrigin": [0, 200, 0], "detectorU": [1, 0, 0],
                       "detectorV": [0, 0, 1], "size": [8, 8], "spacing": [4, 4]}, file)
        return "view.json"

    def test_several_bones_in_one_run(self):
        self.succeed("build", "ct.nii.gz", "--labels", "labels.nii.gz", "--label", "26", "-o", "alone", *SMALL)
        with open("names.csv", "w") as file:
            file.write("25,femur/left\n")
        out, _ = self.succeed("build", "ct.nii.gz", "--labels", "labels.nii.gz", "--label-names", "names.csv",
                              "--label", "femur/left,26", "-o", "both", *SMALL)
        self.assertEqual(sorted(os.listdir("both")), ["femur_left", "label_26"])
        self.assertEqual(sorted(os.listdir("both/label_26")), sorted(os.listdir("alone")))
        for name in ("model_L1.vtu", "contours.vtp", "slices.png"):
            with open(f"alone/{name}", "rb") as alone, open(f"both/label_26/{name}", "rb") as together:
                self.assertEqual(alone.read(), together.read(), name)
        self.assertIn("femur/left", out.split("\nbone ")[1])
        report = read_json("both/femur_left/report.json")
        self.assertEqual((report["input"]["labelName"], report["parameters"]["plan"]["label"]), ("femur/left", 25))
        # The report repeats the build.
        self.succeed("build", "--parameters", "both/femur_left/report.json", "-o", "again")
        with open("both/femur_left/model_L1.vtu", "rb") as first, open("again/model_L1.vtu", "rb") as second:
            self.assertEqual(first.read(), second.read())

    def test_patterns_of_names(self):
        with open("names.csv", "w") as file:
            file.write("25,Rib.left\n26,rib.right\n")
        cost = lambda *label: self.succeed("info", "ct.nii.gz", "--cost", "--labels", "labels.nii.gz", *label)[0]
        named = ("--label-names", "names.csv", "--label")
        both, one = cost("--label", "25,26"), cost("--label", "26")
        for pattern in ("rib.*", "*", "RIB.left,rib.R*", "???.*"):
            self.assertEqual(cost(*named, pattern), both, pattern)
        self.assertEqual(cost(*named, "*.r?ght"), one)
        self.assertEqual(cost("--label", "2*"), both, "by value where there are no names")
        self.assertNotEqual(both, one)
        self.succeed("build", "ct.nii.gz", "--labels", "labels.nii.gz", *named, "rib.*", "-o", "out", *SMALL)
        self.assertEqual(sorted(os.listdir("out")), ["Rib.left", "rib.right"])
        self.refuse("info", "ct.nii.gz", "--cost", "--labels", "labels.nii.gz", *named, "rib?left?", says="no label rib?left?")
        for command in (["crop", "ct.nii.gz", "-o", "o.mha"], ["contours", "ct.nii.gz", "-o", "o.vtp"],
                        ["contours", "ct.nii.gz", "--init", "labels.nii.gz", "-o", "o.vtp"]):
            self.refuse_usage(*command, "--labels", "labels.nii.gz", *named, "rib.*", says="means 2 labels of labels.nii.gz")

    def test_one_bone_of_several_that_fails(self):
        self.labels[:2, :2, :2] = 7  # too small to be tiled
        write_image("labels.nii.gz", self.labels, SPACING)
        code, out, err = bonetk("build", "ct.nii.gz", "--labels", "labels.nii.gz", "--label", "7", "--label", "26", "-o",
                                "out", *SMALL)
        self.assertEqual(code, 1)
        self.assertIn("1 of 2 bones could not be built: label_7", err)
        self.assertIn("bonetk build: label_7: ", err)
        self.assertEqual(os.listdir("out"), ["label_26"])
        self.assertTrue(os.path.exists("out/label_26/report.json"))

    def test_several_bones_are_told_apart(self):
        with open("names.csv", "w") as file:
            file.write('25,"a b"\n26,"a/b"\n')
        self.refuse_usage("build", "ct.nii.gz", "--labels", "labels.nii.gz", "--label-names", "names.csv", "--label",
                          "25,26", "-o", "out", says="folder of two bones")
        self.refuse_usage("build", "ct.nii.gz", "--labels", "labels.nii.gz", "--init", "labels.nii.gz", "--label",
                          "25,26", "-o", "out", says="--init")

    def test_labels_of_initial_contours(self):
        command = ["contours", "ct.nii.gz", "--init", "labels.nii.gz", "-o", "c.vtp"]
        self.refuse_usage(*command, says="Choose one with --label")
        self.succeed(*command, "--label", "26")
        self.refuse_usage("contours", "ct.nii.gz", "--init", "c.vtp", "--label", "26", "-o", "d.vtp",
                          says="--label goes with a label map")

    def test_a_label_map_on_another_grid(self):
        affine = numpy.diag(list(SPACING) + [1.0])
        moved = affine.copy()
        moved[0, 3] += 0.001
        nibabel.save(nibabel.Nifti1Image(self.labels, moved), "rounded.nii.gz")
        wide = numpy.zeros((50, 46, 40), numpy.uint8)
        wide[5:45, 5:41, 5:35] = self.labels
        moved = affine.copy()
        moved[:3, 3] -= [7.5, 7.5, 10]
        nibabel.save(nibabel.Nifti1Image(wide, moved), "wide.nii.gz")
        nibabel.save(nibabel.Nifti1Image(self.labels[:, :, :20], affine), "part.nii.gz")
        self.assertEqual((self.volume("--labels", "rounded.nii.gz", "--label", "25") == 25).sum(),
                         (self.labels == 25).sum())
        build = ["build", "ct.nii.gz", "--label", "25", *SMALL, "--labels"]
        _, quiet = self.succeed(*build, "rounded.nii.gz", "-o", "rounded")
        self.assertNotIn("grid", quiet)
        self.succeed(*build, "labels.nii.gz", "-o", "same")
        _, told = self.succeed(*build, "wide.nii.gz", "-o", "wide")
        self.assertIn("not on the CT's grid", told)
        for folder in ("rounded", "wide"):
            with open("same/model_L1.vtu", "rb") as same, open(folder + "/model_L1.vtu", "rb") as other:
                self.assertEqual(same.read(), other.read(), folder)
        self.refuse(*build, "part.nii.gz", "-o", "out", says="does not cover the CT")
        self.succeed("drr", "ct.nii.gz", "--mask", "wide.nii.gz", "--geometry", self.view(), "-o", "o.mha")

    def test_inputs_that_do_not_belong_together(self):
        """Told quiet or not, and kept; right ones are not doubted."""
        write_image("shifted.nii.gz", numpy.roll(self.labels, 9, axis=1), SPACING)
        write_image("offset.nii.gz", self.ct + 1024, SPACING)
        build = ["build", "--label", "25", *SMALL, "--no-page", "--quiet", "-o", "out", "--force", "--labels"]
        for ct, labels, doubt in (("ct", "labels", None), ("ct", "shifted", "do CT and label map belong together?"),
                                  ("offset", "labels", "are its values HU?")):
            _, told = self.succeed(*build, f"{labels}.nii.gz", f"{ct}.nii.gz")
            report = read_json("out/report.json")
            self.assertEqual(report["shareOfTheOutlineBrighterInside"] > 0.65, labels == "labels")
            _, of_contours = self.succeed("contours", f"{ct}.nii.gz", "--labels", f"{labels}.nii.gz", "--label", "25",
                                          "--quiet", "-o", "c.vtp")
            for text in (told, of_contours, " ".join(report["warnings"]), " ".join(report["doubts"])):
                if doubt:
                    self.assertIn(doubt, text)
                else:
                    self.assertNotIn("?", text)
            if not doubt:
                os.rename("out/model_L1.vtu", "right.vtu")
        _, told = self.succeed("fit", "ct.nii.gz", "right.vtu", "-q", "-o", "f.vtu", "--report", "f.json")
        self.assertEqual(told, "")
        self.assertGreater(read_json("f.json")["shareOfTheOutlineBrighterInside"], 0.9)
        write_image("other.nii.gz", numpy.roll(self.ct, 16, axis=1), SPACING)
        _, told = self.succeed("fit", "other.nii.gz", "right.vtu", "-q", "-o", "f.vtu")
        self.assertIn("do CT and mesh belong together?", told)

    def test_a_closed_surface(self):
        from vtkmodules.vtkFiltersSources import vtkSphereSource
        from vtkmodules.vtkFiltersCore import vtkCleanPolyData
        from vtkmodules.vtkIOGeometry import vtkSTLWriter
        from vtkmodules.vtkIOPLY import vtkPLYWriter
        from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter
        ball, whole = vtkSphereSource(), vtkCleanPolyData()
        ball.SetCenter(-30, -27, 29)  # LPS; the CT's voxels lie at x from -58.5 to 0, y from -52.5 to 0
        ball.SetRadius(15)
        ball.SetThetaResolution(40)
        ball.SetPhiResolution(40)
        whole.SetInputConnection(ball.GetOutputPort())
        for name, writer in (("ball.stl", vtkSTLWriter()), ("ball.ply", vtkPLYWriter()),
                             ("ball.vtp", vtkXMLPolyDataWriter())):
            writer.SetInputConnection(whole.GetOutputPort())
            writer.SetFileName(name)
            writer.Write()
        with open("ball.stl") as file:
            lps = file.read()
        mirrored = [line if "vertex" not in line else
                    "   vertex {} {} {}".format(*[s * float(w) for s, w in zip((-1, -1, 1), line.split()[1:])])
                    for line in lps.splitlines()]
        mirrored[0] = "solid SPACE=RAS"
        with open("ras.stl", "w") as file:
            file.write("\n".join(mirrored) + "\n")
        index = [numpy.arange(n) * s for n, s in zip(SIZE, SPACING)]
        x, y, z = numpy.meshgrid(*index, indexing="ij")
        truth = (x - 30) ** 2 + (y - 27) ** 2 + (z - 29) ** 2 < 15 ** 2
        for name in ("ball.stl", "ball.ply", "ball.vtp", "ras.stl"):
            self.succeed("crop", "ct.nii.gz", "--labels", name, "--margin", "100", "-o", "o.nii.gz", "--write-labels",
                         "l.nii.gz")
            voxels = nibabel.load("l.nii.gz").get_fdata() > 0
            self.assertEqual(voxels.shape, SIZE)
            # The facets lie a little inside the ball.
            self.assertLess((voxels ^ truth).sum(), 0.03 * truth.sum(), name)
        ball.SetCenter(500, 0, 0)
        writer.Write()
        self.refuse("build", "ct.nii.gz", "--labels", "ball.vtp", "-o", "out", says="no voxel of the CT")
        self.refuse_usage("build", "ct.nii.gz", "--labels", "ball.stl", "--label", "2", "-o", "out", says="--label")


class Series(TestCase):
    def setUp(self):
        super().setUp()
        self.ct, self.labels = two_bones()
        os.mkdir("dicom")

    def write(self, folder, series, number, shift=0, **options):
        os.makedirs(folder, exist_ok=True)
        for k in range(SIZE[2]):
            write_slice(f"{folder}/{number}_{k:03}.dcm", self.ct[:, :, k] + shift, 2.0 * k, series, number, **options)

    def values(self, *options):
        out, err = self.succeed("info", "dicom", *options)
        return [line for line in out.splitlines() if line.startswith("values")][0].split()[1], err

    def test_the_one_volume_beside_scouts_and_copies_in_nested_folders(self):
        self.write("dicom/study/series", "1.2.3.5", 3)
        write_slice("dicom/scout.dcm", self.ct[:, :, 0], 0, "1.2.3.6", 1, "Topogram", "ORIGINAL\\PRIMARY\\LOCALIZER")
        write_slice("dicom/key.dcm", self.ct[:, :, 0], 0, "1.2.3.7", 9, "Key image", "DERIVED\\SECONDARY")
        with open("dicom/study/series/3_004.dcm", "rb") as file, open("dicom/copy.dcm", "wb") as copy:
            copy.write(file.read())
        with open("dicom/readme.txt", "w") as file:
            file.write("no DICOM file")
        value, err = self.values()
        self.assertEqual(value, "-50")
        for says in ("1 scout passed over, such as dicom/scout.dcm", "single image passed over, dicom/key.dcm",
                     "1 copied file passed over"):
            self.assertIn(says, err)

    def test_one_of_several_series(self):
        self.write("dicom", "1.2.3.5", 3)
        self.write("dicom", "1.2.3.6", 4, shift=7, description="Soft tissue")
        for command in (["info", "dicom"], ["build", "dicom", "--init", "c.vtp", "-o", "out"]):
            error = self.refuse_usage(*command, says="--series")
            self.assertIn("number 3 (CT, 'Bone', 30 slices of 40 x 36), number 4 (CT, 'Soft tissue', 30 slices", error)
        for series, value in (("3", "-50"), ("4", "-43"), ("Soft tissue", "-43"), ("1.2.3.5", "-50")):
            self.assertEqual(self.values("--series", series)[0], value)
        self.refuse("info", "dicom", "--series", "5", says="no DICOM series '5'; it has number 3 (")
        write_image("ct.nii.gz", self.ct, SPACING)
        self.refuse("info", "ct.nii.gz", "--series", "3", says="ct.nii.gz")

    def test_two_images_at_one_place(self):
        self.write("dicom", "1.2.3.5", 3)
        write_slice("dicom/again.dcm", self.ct[:, :, 4] + 9, 8.0, "1.2.3.5")
        error = self.refuse("info", "dicom", says="at one place")
        self.assertIn("dicom/3_004.dcm", error)
        self.assertIn("dicom/again.dcm", error)

    def test_no_volume(self):
        self.refuse("info", "dicom", says="without a DICOM series")
        write_slice("dicom/scout.dcm", self.ct[:, :, 0], 0, "1.2.3.6", 1, "Topogram", "ORIGINAL\\PRIMARY\\LOCALIZER")
        self.refuse("info", "dicom", says="scout")
        write_slice("dicom/a.dcm", self.ct[:, :, 0], 0, "1.2.3.7", 2)
        self.refuse("info", "dicom", says="one slice")


if __name__ == "__main__":
    main()
