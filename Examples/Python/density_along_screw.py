"""Density along a screw's path: from a CT to a figure.

A CT of an analytic femur with its label map becomes a density model, and the figure shows the model's density from the
lateral cortex through the neck into the head, with the CT's own voxels.
"""
import argparse

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
import numpy.typing as npt

import bonetk


def options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("figure", nargs="?", default="density_along_screw.png", help="file of the figure")
    parser.add_argument("--spacing", type=float, default=1.0, help="of the CT's voxels, mm")
    parser.add_argument("--tetrahedra", type=int, default=20000, help="of the model")
    return parser.parse_args()


def screw_path(mesh: bonetk.DensityMesh) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Start and end: along the neck, from the bone's side to the middle of its head."""
    points = mesh.points
    top = points[points[:, 2] > points[:, 2].max() - 45]
    shaft = points[points[:, 2] < points[:, 2].max() - 80].mean(axis=0)
    outward = top.mean(axis=0) - shaft
    outward[2] = 0
    outward /= np.linalg.norm(outward)
    head = top[(top - shaft) @ outward > ((top - shaft) @ outward).max() - 20].mean(axis=0)
    start = head - 95 * (outward + [0, 0, 0.7]) / np.linalg.norm(outward + [0, 0, 0.7])
    return start, head


def main() -> None:
    asked = options()
    ct, regions = bonetk.phantom("femur", spacing=[asked.spacing] * 3)
    labels = bonetk.Image((regions.array > 0).astype(np.int16), regions.origin, regions.spacing, regions.direction)
    model = bonetk.build(ct, labels, tetrahedra=asked.tetrahedra, degree=3, levels=[0.2])
    mesh = model[0]

    start, end = screw_path(mesh)
    share = np.linspace(0, 1, 400)
    path = start + share[:, None] * (end - start)
    density = mesh.evaluate(path)
    distance = share * np.linalg.norm(end - start)
    index = np.rint((path - ct.origin) / ct.spacing).astype(int)
    inside = ((index >= 0) & (index < ct.shape[::-1])).all(axis=1)
    voxels = np.full(len(path), np.nan)
    voxels[inside] = ct.array[tuple(index[inside].T[::-1])]

    fig, axes = plt.subplots(1, 2, figsize=(11, 4.5), gridspec_kw={"width_ratios": [1, 2.2]})
    view = bonetk.XRayGeometry.framing(mesh.points.min(axis=0) - 5, mesh.points.max(axis=0) + 5, pixels=400)
    axes[0].imshow(bonetk.drr(mesh, view, hu_to_attenuation="water").array[0], cmap="gray")
    axes[0].plot(*view.project(path[[0, -1]]).T, color="tab:orange", linewidth=3)
    axes[0].set_title("Radiograph from the front, screw")
    axes[0].axis("off")
    axes[1].plot(distance, voxels, color="0.7", label="CT, nearest voxel")
    axes[1].plot(distance, density, color="tab:blue", label="model, degree 3")
    axes[1].set(xlabel="distance along the screw (mm)", ylabel="density (HU)", title="Density along the screw")
    axes[1].legend()
    fig.tight_layout()
    fig.savefig(asked.figure, dpi=110)
    in_bone = np.isfinite(density)
    length = in_bone.sum() / len(path) * distance[-1]
    print(f"{length:.1f} mm of the path lie in bone, mean density {density[in_bone].mean():.0f} HU")
    print(f"difference to the voxels there: {np.nanmean(np.abs(density - voxels)):.0f} HU on average")


if __name__ == "__main__":
    main()
