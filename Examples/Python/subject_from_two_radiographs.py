"""A subject's bone from two radiographs and an atlas.

subject_from_two_radiographs.py [FIGURE.png]: analytic femora of several seeds become an atlas; a subject that is not among
its models is recovered from its radiographs from the front and the side, and the figure shows how near the result is.
"""
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

import bonetk

DEGREE = 1
SUBJECTS = 8
WATER = 0.02059  # attenuation per mm at 60 keV


def xray_of(mesh, view):
    """What a bone adds to the line integrals of the attenuation of the soft tissue about it, which is like water."""
    return bonetk.Image(bonetk.drr(mesh, view).array * np.float32(WATER / 1000))


def ct_of(seed):
    ct, regions = bonetk.phantom("femur", seed, spacing=(1.5, 1.5, 1.5))
    return ct, bonetk.Image((regions.array > 0).astype(np.int16), regions.origin, regions.spacing, regions.direction)


def model_of(seed):
    """A density model with a topology of its own."""
    return bonetk.build(*ct_of(seed), tetrahedra=6000, degree=DEGREE, levels=[0.5])[0]


def on_topology(standard, seed):
    """The standard model's topology on a subject, with the subject's density."""
    return bonetk.fit_density(ct_of(seed)[0], bonetk.register_mesh(standard, model_of(seed)), degree=DEGREE)


def main():
    figure = sys.argv[1] if len(sys.argv) > 1 else "subject_from_two_radiographs.png"
    standard = model_of(0)
    atlas = bonetk.train([on_topology(standard, seed) for seed in range(1, SUBJECTS + 1)])
    print(atlas)

    truth = model_of(100)
    lower, upper = truth.points.min(axis=0) - 15, truth.points.max(axis=0) + 15
    views = [bonetk.XRayGeometry.framing(lower, upper, beam=beam, pixels=256) for beam in ((0, 1, 0), (1, 0, 0))]
    xrays = [xray_of(truth, view) for view in views]
    found, result = bonetk.register_deformable(atlas, list(zip(xrays, views)))

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
    fig.savefig(figure, dpi=110)


if __name__ == "__main__":
    main()
