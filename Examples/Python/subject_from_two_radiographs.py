"""A subject's bone from two radiographs and an atlas.

Analytic femora of several seeds become an atlas; a subject that is not among its models is recovered from its radiographs
from the front and the side, and the figure shows how near the result is.
"""
import argparse
import functools

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

import bonetk

DEGREE = 1
WATER = 0.02059  # attenuation per mm at 60 keV


def options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("figure", nargs="?", default="subject_from_two_radiographs.png", help="file of the figure")
    parser.add_argument("--subjects", type=int, default=8, help="of the atlas")
    parser.add_argument("--spacing", type=float, default=1.5, help="of the CTs' voxels, mm")
    parser.add_argument("--tetrahedra", type=int, default=6000, help="of a model")
    parser.add_argument("--pixels", type=int, default=256, help="along the longer side of a radiograph")
    parser.add_argument("--iterations", type=int, default=None, help="of the registration at the most")
    return parser.parse_args()


def xray_of(mesh: bonetk.DensityMesh, view: bonetk.XRayGeometry) -> bonetk.Image:
    """What a bone adds to the line integrals of the attenuation of the soft tissue about it, which is like water."""
    return bonetk.Image(bonetk.drr(mesh, view).array * np.float32(WATER / 1000))


class Subjects:
    """Femora by their seeds, as a scanner and a segmentation give them."""

    def __init__(self, spacing: float, tetrahedra: int) -> None:
        self.spacing = [spacing] * 3
        self.tetrahedra = tetrahedra

    @functools.cache
    def ct(self, seed: int) -> tuple[bonetk.Image, bonetk.Image]:
        ct, regions = bonetk.phantom("femur", seed, spacing=self.spacing)
        bone = (regions.array > 0).astype(np.int16)
        return ct, bonetk.Image(bone, regions.origin, regions.spacing, regions.direction)

    def model(self, seed: int) -> bonetk.DensityMesh:
        """A density model with a topology of its own."""
        return bonetk.build(*self.ct(seed), tetrahedra=self.tetrahedra, degree=DEGREE, levels=[0.5])[0]

    def on_topology(self, standard: bonetk.DensityMesh, seed: int) -> bonetk.DensityMesh:
        """The standard model's topology on a subject, with the subject's density."""
        return bonetk.fit_density(self.ct(seed)[0], bonetk.register_mesh(standard, self.model(seed)), degree=DEGREE)


def main() -> None:
    asked = options()
    subjects = Subjects(asked.spacing, asked.tetrahedra)
    standard = subjects.model(0)
    atlas = bonetk.train([subjects.on_topology(standard, seed) for seed in range(1, asked.subjects + 1)])
    print(atlas)

    truth = subjects.model(100)
    lower, upper = truth.points.min(axis=0) - 15, truth.points.max(axis=0) + 15
    views = [bonetk.XRayGeometry.framing(lower, upper, beam=beam, pixels=asked.pixels) for beam in ((0, 1, 0), (1, 0, 0))]
    xrays = [xray_of(truth, view) for view in views]
    limits = {} if asked.iterations is None else {"iterations": asked.iterations}
    found, result = bonetk.register_deformable(atlas, list(zip(xrays, views)), **limits)

    # Points of the recovered surface that lie in the true bone, and how far its density is off where both are bone.
    places = np.random.default_rng(1).uniform(lower, upper, (40000, 3))
    true, own = truth.evaluate(places), found.evaluate(places)
    both = np.isfinite(true) & np.isfinite(own)
    dice = 2 * both.sum() / (np.isfinite(true).sum() + np.isfinite(own).sum())
    print(f"quality: {result['quality']}; Dice {dice:.3f}; volume {found.volume / truth.volume - 1:+.1%}, "
          f"mass {found.mass / truth.mass - 1:+.1%}")

    fig, axes = plt.subplots(2, 3, figsize=(10, 8))
    for row, view, xray in zip(axes, views, xrays):
        own_view = xray_of(found, view).array[0]
        mean = xray_of(atlas.mean, view).array[0]
        top = xray.array.max()
        for axis, image, title in zip(row, (xray.array[0], mean - xray.array[0], own_view - xray.array[0]),
                                      ("X-ray", "atlas' mean less X-ray", "recovered less X-ray")):
            signed = title != "X-ray"
            axis.imshow(image, cmap="RdBu_r" if signed else "gray", vmin=-top / 2 if signed else 0,
                        vmax=top / 2 if signed else top)
            axis.set_title(title)
            axis.axis("off")
    fig.suptitle(f"Femur of seed 100 from two X-rays: Dice {dice:.3f}, {result['quality']}")
    fig.tight_layout()
    fig.savefig(asked.figure, dpi=110)


if __name__ == "__main__":
    main()
