#!/usr/bin/python3
"""Are the contours of real bones valid on every slice? Reads contours.vtp with VTK alone and shares no code with BoneTK.

Run by hand: BONETK names the program, BONETK_DATA the folder of real data. For every bone with a label map, at slice
steps of 1, 2 and 3 mm, it makes the contours and tests on each slice
  simple    no contour crosses or touches itself or another one
  nested    the contour around one of layer n has layer n - 1 and is of bone; holes lie in bone
  apart     distance between a contour and the next inside it, at least the distance asked for
  axis      every innermost contour has a connected medial axis with one cycle for each of its holes, inside it
  labels    every component of the label (of 4 mm^2 or more on both label slices next to the plane) lies in a contour,
            and every hole in it is open
and, with the label as reference, the mean distance of the periosteal contours to the label's outline.
Writes Documentation/validation/contours_valid.md; exit status 1 where anything is amiss."""
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import nibabel
import numpy
import scipy.ndimage
from scipy.spatial import cKDTree
from vtk import vtkXMLPolyDataReader
from vtk.util.numpy_support import vtk_to_numpy

from report import made_by

ROOT = Path(__file__).resolve().parents[2]
BONETK = os.environ["BONETK"]
DATA = Path(os.environ["BONETK_DATA"])
BONES = [("hip_ct", 1), ("hip_ct", 2)] + [("pelvis_ct_3mm", label) for label in range(1, 6)]
STEPS = (1, 2, 3)
LAYER_DISTANCE = 0.8  # mm, asked for and tested
SMALLEST = 4.0  # mm^2


class Line:
    """A closed contour or a branch of an axis in plane coordinates."""

    def __init__(self, points, layer, region, axis):
        self.points, self.layer, self.region, self.axis = points, layer, region, axis

    def edges(self):
        ends = self.points[1:] if self.axis else numpy.roll(self.points, -1, axis=0)
        return self.points[: len(ends)], ends


def read_contours(path):
    """Slices: origin height and lines; and the frame's matrix, whose rows are U, V, N."""
    reader = vtkXMLPolyDataReader()
    reader.SetFileName(str(path))
    reader.Update()
    data = reader.GetOutput()
    field = data.GetFieldData()
    normal = vtk_to_numpy(field.GetArray("SliceNormal"))[0]
    u = vtk_to_numpy(field.GetArray("SliceU"))[0]
    frame = numpy.array([u, numpy.cross(normal, u), normal])
    origins = vtk_to_numpy(field.GetArray("SliceOrigin"))
    points = vtk_to_numpy(data.GetPoints().GetData()) @ frame.T
    cells = {name: vtk_to_numpy(data.GetCellData().GetArray(name)) for name in ("Slice", "Layer", "Region", "Axis")}
    offsets = vtk_to_numpy(data.GetLines().GetOffsetsArray())
    connectivity = vtk_to_numpy(data.GetLines().GetConnectivityArray())
    slices = [(origin @ normal, []) for origin in origins]
    for c in range(len(offsets) - 1):
        line = points[connectivity[offsets[c] : offsets[c + 1]]]
        axis = bool(cells["Axis"][c])
        if axis and len(line) == 2 and (line[0] == line[1]).all():
            line = line[:1]
        slices[cells["Slice"][c]][1].append(Line(line[:, :2], cells["Layer"][c], cells["Region"][c], axis))
    return slices, frame


def cross(a, b):
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def meeting_edges(first, second, same):
    """Pairs of edges of two lines that cross or touch, neighbours on one line not counted."""
    a, b = (x[:, None] for x in first.edges())
    c, d = (x[None] for x in second.edges())
    if 0 in (a.size, c.size):
        return 0
    meets = (cross(b - a, c - a) * cross(b - a, d - a) <= 0) & (cross(d - c, a - c) * cross(d - c, b - c) <= 0)
    for k in range(2):
        meets &= numpy.minimum(a, b)[..., k] <= numpy.maximum(c, d)[..., k]
        meets &= numpy.minimum(c, d)[..., k] <= numpy.maximum(a, b)[..., k]
    if same:
        n = len(meets)
        for shift in (0, 1):
            meets[numpy.arange(n), (numpy.arange(n) + shift) % n] = False
            meets[(numpy.arange(n) + shift) % n, numpy.arange(n)] = False
        return int(meets.sum()) // 2
    return int(meets.sum())


def contains(polygon, points):
    a, b = polygon.edges()
    points = numpy.atleast_2d(points)[:, None]
    spans = (a[None, :, 1] > points[..., 1]) != (b[None, :, 1] > points[..., 1])
    with numpy.errstate(divide="ignore", invalid="ignore"):
        x = a[:, 0] + (points[..., 1] - a[:, 1]) / (b[:, 1] - a[:, 1]) * (b[:, 0] - a[:, 0])
    return (spans & (points[..., 0] < x)).sum(axis=1) % 2 == 1


def distances(points, polygon):
    a, b = polygon.edges()
    d = b - a
    t = numpy.clip(((points[:, None] - a) * d).sum(-1) / numpy.maximum((d * d).sum(-1), 1e-30), 0, 1)
    return numpy.linalg.norm(points[:, None] - a - t[..., None] * d, axis=2).min(axis=1)


def area(polygon):
    a, b = polygon.edges()
    return 0.5 * cross(a, b).sum()


def parents_of(loops):
    """Index of the smallest contour around each; -1: none."""
    areas = [abs(area(loop)) for loop in loops]
    result = []
    for i, loop in enumerate(loops):
        around = [
            j for j in range(len(loops)) if areas[j] > areas[i] and contains(loops[j], loop.points[0])[0]
        ]
        result.append(min(around, key=lambda j: areas[j], default=-1))
    return result


def axis_shape(branches):
    """Number of connected parts and of cycles of a graph of polylines that share end points."""
    ids = {}
    parent = []

    def find(x):
        while parent[x] != x:
            x = parent[x]
        return x

    def node(q):
        key = (q[0], q[1])
        if key not in ids:
            ids[key] = len(parent)
            parent.append(len(parent))
        return ids[key]

    edges = 0
    for branch in branches:
        nodes = [node(q) for q in branch.points]
        for a, b in zip(nodes, nodes[1:]):
            edges += 1
            parent[find(a)] = find(b)
    parts = len({find(x) for x in range(len(parent))})
    return parts, edges - len(parent) + parts


def check_axes(loops, parents, axes, tally):
    """Each innermost contour of bone has one axis, inside it and outside its holes, of the right shape."""
    owners = [[] for _ in loops]
    for axis in axes:
        around = [j for j, loop in enumerate(loops) if loop.region != 0 and contains(loop, axis.points[0])[0]]
        owner = min(around, key=lambda j: abs(area(loops[j])), default=None)
        met = sum(meeting_edges(loop, axis, False) for loop in loops)
        in_hole = any(loop.region == 0 and contains(loop, axis.points[0])[0] for loop in loops)
        if owner is None or met or in_hole or axis.layer != loops[owner].layer + 1:
            tally["axes outside"] += 1
        else:
            owners[owner].append(axis)
    for j, loop in enumerate(loops):
        inside = [i for i in range(len(loops)) if parents[i] == j]
        holes = sum(loops[i].region == 0 for i in inside)
        if loop.region == 0 or holes < len(inside):
            tally["axes outside"] += len(owners[j])
            continue
        tally["innermost"] += 1
        if not owners[j] or axis_shape(owners[j]) != (1, holes):
            tally["axes amiss"] += 1
        tally["axes"] += 1 if owners[j] else 0
        tally["cycles"] += holes


def check_slice(lines, tally):
    loops = [line for line in lines if not line.axis]
    axes = [line for line in lines if line.axis]
    for i, loop in enumerate(loops):
        tally["crossings"] += meeting_edges(loop, loop, True)
        tally["crossings"] += sum(meeting_edges(loop, other, False) for other in loops[:i])
        tally[f"layer {loop.layer}" if loop.region else "holes"] += 1
        if (area(loop) > 0) != (loop.region != 0):
            tally["not nested"] += 1
    parents = parents_of(loops)
    for loop, p in zip(loops, parents):
        around = loops[p] if p >= 0 else None
        if around is None:
            tally["not nested"] += loop.layer != 0 or loop.region == 0
        elif loop.region == 0 or around.region == 0:
            tally["not nested"] += loop.layer != 0 or around.layer != 0 or around.region == loop.region
        else:
            tally["not nested"] += loop.layer != around.layer + 1
        for other, q in zip(loops, parents):
            # The next layer in, and holes beside an inner contour.
            hole_beside = q == p and p >= 0 and loop.layer > 0 and other.region == 0
            if loop.layer > 0 and (other is around or hole_beside):
                gap = min(distances(loop.points, other).min(), distances(other.points, loop).min())
                tally["least distance"] = min(tally["least distance"], gap)
    check_axes(loops, parents, axes, tally)


def read_label(name, label):
    image = nibabel.load(DATA / name / f"{name.split('_')[0]}_labels.nii.gz")
    inside = numpy.asarray(image.dataobj) == label
    affine = numpy.diag([-1.0, -1.0, 1.0, 1.0]) @ image.affine
    return inside, affine


def outline_points(mask):
    """Middles of the pixel edges between a section of the label and what is outside, in index coordinates."""
    padded = numpy.pad(mask, 1)
    points = []
    for axis in (0, 1):
        change = numpy.argwhere(numpy.diff(padded.astype(numpy.int8), axis=axis) != 0).astype(float)
        change[:, axis] += 0.5
        points.append(change - 1)
    return numpy.concatenate(points)


def check_labels(slices, frame, inside, affine, tally):
    """The slices are those of the third voxel axis, which is the frame's normal, up to sign."""
    inverse = numpy.linalg.inv(affine)
    for height, lines in slices:
        k = (inverse @ numpy.append(frame[2] * height, 1.0))[2]
        base, above = int(numpy.floor(k + 1e-3)), int(numpy.ceil(k - 1e-3))
        if not (0 <= base and above < inside.shape[2]):
            continue
        mask = inside[:, :, base] & inside[:, :, above]
        components, count = scipy.ndimage.label(mask, numpy.ones((3, 3)))
        pixel = abs(numpy.linalg.det(affine[:3, :3])) / numpy.linalg.norm(affine[:3, 2])
        loops = [line for line in lines if not line.axis and line.layer == 0]
        for c in range(1, count + 1):
            voxels = numpy.argwhere(components == c)
            if len(voxels) * pixel < SMALLEST:
                continue
            tally["components"] += 1
            index = numpy.column_stack([voxels, numpy.full(len(voxels), k), numpy.ones(len(voxels))])
            plane = (index @ affine.T)[:, :3] @ frame[:2].T
            covered = sum(contains(loop, plane).astype(int) for loop in loops) % 2 if loops else 0
            if numpy.sum(covered) == 0:
                tally["not found"] += 1
        check_label_holes(loops, inside[:, :, base] | inside[:, :, above], k, frame, affine, pixel, tally)
        if base == above and loops and mask.any():
            edge = outline_points(mask)
            index = numpy.column_stack([edge, numpy.full(len(edge), k), numpy.ones(len(edge))])
            outline = (index @ affine.T)[:, :3] @ frame[:2].T
            points = numpy.concatenate([dense(loop) for loop in loops])
            found = 0.5 * (
                cKDTree(outline).query(points)[0].mean() + cKDTree(points).query(outline)[0].mean()
            )
            tally["outline"].append(found)


def check_label_holes(loops, mask, k, frame, affine, pixel, tally):
    """Background that the label encloses on both label slices next to the plane must not be bone throughout."""
    components, count = scipy.ndimage.label(numpy.pad(~mask, 1, constant_values=True))
    components = components[1:-1, 1:-1]
    border = set(components[0]) | set(components[-1]) | set(components[:, 0]) | set(components[:, -1])
    for c in range(1, count + 1):
        voxels = numpy.argwhere(components == c)
        if c in border or len(voxels) * pixel < SMALLEST:
            continue
        tally["label holes"] += 1
        index = numpy.column_stack([voxels, numpy.full(len(voxels), k), numpy.ones(len(voxels))])
        plane = (index @ affine.T)[:, :3] @ frame[:2].T
        if (sum(contains(loop, plane).astype(int) for loop in loops) % 2).all():
            tally["closed"] += 1


def dense(loop, step=0.1):
    """Points along a contour."""
    a, b = loop.edges()
    parts = [numpy.linspace(p, q, max(2, int(numpy.linalg.norm(q - p) / step)), endpoint=False) for p, q in zip(a, b)]
    return numpy.concatenate(parts)


def examine(name, label, step, folder, options=()):
    output = Path(folder) / f"{name}_{label}_{step}.vtp"
    data = DATA / name
    stem = name.split("_")[0]
    command = [BONETK, "contours", data / f"{stem}_ct.nii.gz", "--labels", data / f"{stem}_labels.nii.gz"]
    command += ["--label", str(label), "--slice-step", str(step), "--quiet", "-o", output, *options]
    subprocess.run([str(word) for word in command], check=True, stderr=subprocess.DEVNULL)
    slices, frame = read_contours(output)
    keys = "crossings holes innermost axes cycles components".split()
    keys += ["not nested", "axes outside", "axes amiss", "not found", "label holes", "closed", "layer 0", "layer 1", "layer 2"]
    tally = dict.fromkeys(keys, 0)
    tally["least distance"] = numpy.inf
    tally["outline"] = []
    tally["slices"] = len(slices)
    for _, lines in slices:
        check_slice(lines, tally)
    check_labels(slices, frame, *read_label(name, label), tally)
    return tally


def passes(tally):
    amiss = sum(tally[key] for key in ("crossings", "not nested", "axes outside", "axes amiss", "not found", "closed"))
    return amiss == 0 and tally["least distance"] >= LAYER_DISTANCE - 1e-6


HEADER = """# Contours of real bones are valid

{made_by}: contours by `bonetk contours --keep-small` with the label map, resampled and with medial axes as
written, read and tested by a program of its own on every slice. Contours by layer (0 periosteal, 1 endosteal, 2 medullary) and
holes; *crossings* of contours with themselves or one another; *not nested*: a contour in the wrong layer's; *distance*: the
least between a contour and the next inside it (asked for: {distance} mm); *axes*: of the innermost contours, how many have one,
and how many are outside, in parts, or lack a cycle around a hole; *label components* of at least {smallest} mm² on both label
slices next to a plane, and how many no periosteal contour covers; *label holes* likewise,
and how many were closed.

| bone | step (mm) | slices | contours 0 / 1 / 2 | holes | crossings | not nested | distance (mm) | axes (cycles) | amiss | label components | not found | label holes | closed |
|---|---|---|---|---|---|---|---|---|---|---|---|---|---|
"""


OUTLINE = """
Mean distance (mm) of a slice's periosteal contours to the label's outline, both ways, on label slices. The outline is taken as
the middles of the pixels' edges, which alone is about a quarter of a pixel off any smooth curve. Asked for: at most
{limit} mm on every slice of hip_ct 1.

| bone | contours | slices | mean | worst | slices above {limit} mm |
|---|---|---|---|---|---|
"""
LIMIT = 0.35


def outline_rows(folder):
    """Rows of the second table, and whether the femur keeps the limit."""
    rows = []
    good = True
    for label in (1, 2):
        for name, options in (("as given", ()), ("refined", ("--refine",))):
            found = examine("hip_ct", label, 1, folder, ("--keep-small", *options))["outline"]
            above = sum(value > LIMIT for value in found)
            good &= label != 1 or above == 0
            mean = sum(found) / len(found)
            rows.append(f"| hip_ct {label} | {name} | {len(found)} | {mean:.3f} | {max(found):.3f} | {above} |")
            print(rows[-1], flush=True)
    return rows, good


def main():
    rows = []
    good = True
    with tempfile.TemporaryDirectory() as folder:
        for name, label in BONES:
            for step in STEPS:
                t = examine(name, label, step, folder, ("--keep-small", "--layer-distance", str(LAYER_DISTANCE)))
                good &= passes(t)
                rows.append(
                    f"| {name} {label} | {step} | {t['slices']} | {t['layer 0']} / {t['layer 1']} / {t['layer 2']} "
                    f"| {t['holes']} | {t['crossings']} | {t['not nested']} | {t['least distance']:.3f} "
                    f"| {t['axes']} of {t['innermost']} ({t['cycles']}) | {t['axes outside'] + t['axes amiss']} "
                    f"| {t['components']} | {t['not found']} | {t['label holes']} | {t['closed']} |"
                )
                print(rows[-1], flush=True)
        outlines, close = outline_rows(folder)
    path = ROOT / "Documentation" / "validation" / "contours_valid.md"
    path.write_text(HEADER.format(made_by=made_by(__file__), distance=LAYER_DISTANCE, smallest=f"{SMALLEST:g}") + "\n".join(rows + [OUTLINE.format(limit=LIMIT)]) + "\n".join(outlines) + "\n")
    return 0 if good and close else 1


if __name__ == "__main__":
    sys.exit(main())
