"""A bone with three bright beads, known in LPS mm, as images of any orientation."""
import nibabel
import numpy

CENTRE = numpy.array([17.0, -23.0, 41.0])
AXES = numpy.array([34.0, 24.0, 44.0])  # half the ellipsoid's axes, mm
CORTEX = 3.0
BEAD = 4.5  # mm, radius
BEADS = {"left anterior superior": CENTRE + [12, -9, 17], "right posterior inferior": CENTRE + [-9, 8, -21],
         "right anterior": CENTRE + [-18, -2, -6]}
DENSITY = {"outside": 0, "cortex": 1100, "trabecular": 300, "bead": 3000}
SPACING = (1.1, 1.2, 1.3)
REACH = 54.0  # mm, of the image about the centre


def rotation(axis, degrees):
    """By Rodrigues' formula."""
    x, y, z = numpy.array(axis, float) / numpy.linalg.norm(axis)
    k = numpy.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    angle = numpy.radians(degrees)
    return numpy.eye(3) + numpy.sin(angle) * k + (1 - numpy.cos(angle)) * k @ k


POSE = rotation((2, -1, 3), 28)  # columns: the ellipsoid's axes
# Directions of the voxel axes in RAS, by name.
ORIENTATIONS = {"RAS": numpy.diag([1.0, 1, 1]), "LPI": numpy.diag([-1.0, -1, -1]),
                "PSR": numpy.array([[0.0, 0, 1], [-1, 0, 0], [0, 1, 0]]),
                "oblique": rotation((1, 2, -1), 24) @ numpy.array([[0.0, -1, 0], [1, 0, 0], [0, 0, -1]])}


def sizes(x):
    """Of points in LPS: how far out in the ellipsoid (1 at its surface), and in that within the cortex."""
    local = (x - CENTRE) @ POSE
    return numpy.sqrt(((local / AXES) ** 2).sum(-1)), numpy.sqrt(((local / (AXES - CORTEX)) ** 2).sum(-1))


def density(x):
    """Density at points in LPS, which a voxel's width blurs a little."""
    outer, inner = sizes(x)
    share = lambda size: numpy.clip(0.5 + (1 - size) * AXES.mean() / 1.2, 0, 1)
    value = DENSITY["outside"] + (DENSITY["cortex"] - DENSITY["outside"]) * share(outer)
    value += (DENSITY["trabecular"] - DENSITY["cortex"]) * share(inner)
    for bead in BEADS.values():
        inside = numpy.clip(0.5 + (BEAD - numpy.linalg.norm(x - bead, axis=-1)) / 1.2, 0, 1)
        value += (DENSITY["bead"] - value) * inside
    return value


def write(orientation, ct, labels):
    """Writes a CT and its label map; returns the affine from voxels to LPS and the number of voxels along each axis."""
    directions = ORIENTATIONS[orientation] * SPACING
    size = [int(numpy.ceil(2 * REACH / spacing)) for spacing in SPACING]
    affine = numpy.eye(4)
    affine[:3, :3] = directions
    centre = CENTRE * [-1, -1, 1]
    affine[:3, 3] = centre - directions @ (numpy.array(size) - 1) / 2
    voxels = numpy.stack(numpy.meshgrid(*map(numpy.arange, size), indexing="ij"), axis=-1)
    x = (voxels @ affine[:3, :3].T + affine[:3, 3]) * [-1, -1, 1]
    outer, inner = sizes(x)
    nibabel.save(nibabel.Nifti1Image(density(x).round().astype(numpy.int16), affine), ct)
    nibabel.save(nibabel.Nifti1Image(((outer <= 1).astype(numpy.uint8)), affine), labels)
    return numpy.diag([-1.0, -1, 1, 1]) @ affine, size
