"""Images of other libraries and files as Image, without copies where the voxels allow it."""
from __future__ import annotations

import os
from typing import Any

from ._bonetk import Image, UsageError, _read_ct, _read_labels, write_image

# NumPy is imported where it is needed: commands and builds of files do without its 20 MB.
__all__ = ["Image", "as_image", "read_image", "write_image"]


def read_image(path: str | os.PathLike[str], *, labels: bool = False, series: str = "") -> Image:
    """Reads a volume (.nii.gz, .mha, .nrrd, ...) or a folder with a DICOM series.

    labels: a label map, which becomes int16; others become float32
    series: number, UID or description of the series, where the folder holds several
    """
    name = os.fspath(path)
    return _read_labels(name) if labels else _read_ct(name, series)


def as_image(image: Any, *, labels: bool = False) -> Image:
    """An Image of what holds one.

    image: an Image, a path, an image of nibabel, itk or SimpleITK, or an array [z, y, x] of spacing 1 mm at the origin
    labels: of a path: a label map

    Voxels in float32 or int16 are shared, not copied; nibabel's frame, RAS, becomes LPS.
    """
    if isinstance(image, Image):
        return image
    if isinstance(image, (str, os.PathLike)):
        return read_image(image, labels=labels)
    if hasattr(image, "affine") and hasattr(image, "dataobj"):
        return _from_nibabel(image)
    if hasattr(image, "GetOrigin") and hasattr(image, "GetSpacing") and hasattr(image, "GetDirection"):
        return _from_itk(image)
    import numpy as np

    if isinstance(image, np.ndarray):
        return Image(image)
    raise UsageError(
        f"{type(image).__name__} is no image: give a bonetk.Image, a path, an array [z, y, x], or an image of nibabel, itk "
        "or SimpleITK"
    )


def _from_nibabel(image: Any) -> Image:
    import numpy as np

    affine = np.diag([-1.0, -1.0, 1.0, 1.0]) @ np.asarray(image.affine, dtype=float)
    spacing = np.linalg.norm(affine[:3, :3], axis=0)
    voxels = np.asanyarray(image.dataobj)
    if voxels.ndim != 3:
        raise UsageError(f"the image of nibabel has {voxels.ndim} axes; three are needed")
    return Image(voxels.T, affine[:3, 3], spacing, affine[:3, :3] / spacing)


def _from_itk(image: Any) -> Image:
    import numpy as np

    module = type(image).__module__
    if module.split(".")[0] == "SimpleITK":
        import SimpleITK

        voxels = SimpleITK.GetArrayViewFromImage(image)
        direction = np.reshape(image.GetDirection(), (3, 3)) if len(image.GetDirection()) == 9 else None
    else:
        import itk

        voxels = itk.array_view_from_image(image)
        direction = np.asarray(itk.array_from_matrix(image.GetDirection()))
    if voxels.ndim != 3 or direction is None:
        raise UsageError("the image must have three axes and one number a voxel")
    return Image(voxels, tuple(image.GetOrigin()), tuple(image.GetSpacing()), direction, owner=image)
