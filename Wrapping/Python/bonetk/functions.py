"""Functions in memory. Their further keywords are the parameters of the filters that they run, see each filter's help."""
from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from . import _bonetk
from ._bonetk import (
    ContourStack,
    DensityHierarchy,
    DensityMesh,
    Image,
    Projector,
    StatisticalModel,
    UsageError,
    XRayGeometry,
)
from .images import as_image

Progress = Callable[[float], object]


def _set(filter_: Any, parameters: dict[str, Any]) -> None:
    for name, value in parameters.items():
        if name not in filter_.parameter_names:
            raise UsageError(
                f'{type(filter_).__name__} has no parameter "{name}"; it has ' + ", ".join(sorted(filter_.parameter_names))
            )
        setattr(filter_, name, value)


def _run(filter_: Any, parameters: dict[str, Any], progress: Progress | None, output: str = "output") -> Any:
    """Runs a filter and hands out its output, which is then its own."""
    _set(filter_, parameters)
    filter_.update(progress)
    return _bonetk._detach(getattr(filter_, output))


def contours(
    image: Any, labels: Any = None, *, initial_contours: ContourStack | None = None, progress: Progress | None = None,
    **parameters: Any,
) -> ContourStack:
    """Contours of a bone in a CT; labels or initial_contours say where it is. Parameters: SnakeContourFilter."""
    f = _bonetk.SnakeContourFilter()
    f.image = as_image(image)
    f.labels = None if labels is None else as_image(labels, labels=True)
    f.initial_contours = initial_contours
    return _run(f, parameters, progress)


def build(
    ct: Any, labels: Any = None, *, contours: ContourStack | None = None,
    progress: Callable[[str, float], object] | None = None, **parameters: Any,
) -> DensityHierarchy:
    """The whole job: from a CT and its label map, or contours, to the levels of a density model.

    progress: a function that is called with the name of a stage and its progress, 0 to 1; what it raises stops the work
    Parameters: label, tetrahedra, levels, slice_step, contour_spacing, ... of the plan, and those of every stage
    (degree, ...); the first stage that has a name takes it.
    """
    return _bonetk._build(
        as_image(ct), None if labels is None else as_image(labels, labels=True), contours, progress, **parameters
    )


def resample(stack: ContourStack, *, progress: Progress | None = None, **parameters: Any) -> ContourStack:
    """Splines through contours, sampled by curvature. Parameters: ContourResampleFilter."""
    f = _bonetk.ContourResampleFilter()
    f.contours = stack
    return _run(f, parameters, progress)


def medial_axes(stack: ContourStack, *, progress: Progress | None = None, **parameters: Any) -> ContourStack:
    """The stack with medial axes of its innermost contours. Parameters: MedialAxisFilter."""
    f = _bonetk.MedialAxisFilter()
    f.contours = stack
    return _run(f, parameters, progress)


def tile(
    stack: ContourStack, *, density_image: Any = None, progress: Progress | None = None, **parameters: Any
) -> DensityMesh:
    """A layered tetrahedral mesh of contours. Parameters: ContourTilingMeshSource."""
    f = _bonetk.ContourTilingMeshSource()
    f.contours = stack
    f.density_image = density_image
    return _run(f, parameters, progress)


def improve(
    mesh: DensityMesh, *, contours: ContourStack | None = None, labels: Any = None, progress: Progress | None = None,
    **parameters: Any,
) -> DensityMesh:
    """The mesh made fit for computing. Parameters: MeshQualityFilter."""
    f = _bonetk.MeshQualityFilter()
    f.mesh = mesh
    f.contours = contours
    f.labels = None if labels is None else as_image(labels, labels=True)
    return _run(f, parameters, progress)


def fit_density(
    image: Any, mesh: DensityMesh, *, weights: Any = None, quantity: str | None = None,
    progress: Progress | None = None, **parameters: Any,
) -> DensityMesh:
    """The mesh with a polynomial density fitted to an image in each tetrahedron. Parameters: DensityFitFilter (degree, ...)."""
    f = _bonetk.DensityFitFilter()
    f.image = as_image(image)
    f.mesh = mesh
    f.weights = weights
    fields = parameters if quantity is None else {**parameters, "quantity": quantity}
    return _run(f, fields, progress)


def simplify(
    mesh: DensityMesh, levels: Sequence[float] = (), *, progress: Progress | None = None, **parameters: Any
) -> DensityHierarchy:
    """Coarser levels of a density mesh.

    levels: numbers of tetrahedra, or shares of the mesh's own where they are below 1
    Parameters: TetraCollapseFilter.
    """
    f = _bonetk.TetraCollapseFilter()
    f.mesh = mesh
    count = 0 if mesh.tetrahedra is None else len(mesh.tetrahedra)
    f.levels = [round(level * count) if level < 1 else level for level in levels]
    return _run(f, parameters, progress)


def sample(mesh: DensityMesh, reference: Any, *, progress: Progress | None = None, **parameters: Any) -> Image:
    """The model's density at the voxel centres of an image. Parameters: DensityImageFilter."""
    f = _bonetk.DensityImageFilter()
    f.mesh = mesh
    f.reference = reference
    return _run(f, parameters, progress)


def calibrate(
    mesh: DensityMesh, *, laws: Sequence[str] = (), progress: Progress | None = None, **parameters: Any
) -> DensityMesh:
    """A model in HU as one in mineral, ash or apparent density. Parameters: DensityCalibrationFilter (line, quantity)."""
    f = _bonetk.DensityCalibrationFilter()
    f.mesh = mesh
    f.laws = list(laws)
    return _run(f, parameters, progress)


def drr(
    source: Any, geometry: XRayGeometry, *, mask: Any = None, progress: Progress | None = None, **parameters: Any
) -> Image:
    """The radiograph of a density mesh, or of a CT: an Image of 1 x rows x columns line integrals on the detector.

    mask: of a CT: the label map whose voxels count
    Parameters: DRRImageFilter, or VoxelDRRImageFilter of a CT.
    """
    f: Any
    if isinstance(source, DensityMesh):
        f = _bonetk.DRRImageFilter()
        f.mesh = source
    else:
        f = _bonetk.VoxelDRRImageFilter()
        f.image = as_image(source)
        f.mask = None if mask is None else as_image(mask, labels=True)
    f.geometry = geometry
    return _run(f, parameters, progress)


def drr_vjp(
    mesh: DensityMesh, geometry: XRayGeometry, pose: Any = None, *, pose_centre: Any = None, **parameters: Any
) -> tuple[np.ndarray, Callable[[Any], dict[str, np.ndarray]]]:
    """The radiograph (rows x columns) and a function from derivatives by its pixels to derivatives by the model.

    The function takes rows x columns numbers and gives a dict of ``pose`` (6; per mm, per radian), ``points`` (n x 3, per
    mm) and ``coefficients`` (m x k). pose and further keywords: see Projector, which is faster for many calls.
    """
    return Projector(mesh, keep=False, **parameters).vjp(geometry, pose, pose_centre=pose_centre)


def drr_derivatives(
    mesh: DensityMesh, geometry: XRayGeometry, pose: Any = None, *, pose_centre: Any = None, by_pose: bool = True,
    shape: Sequence[Any] = (), density: Sequence[Any] = (), **parameters: Any,
) -> tuple[np.ndarray, np.ndarray]:
    """The radiograph (rows x columns) and its derivatives (modes x rows x columns), see Projector.derivatives."""
    projector = Projector(mesh, keep=False, **parameters)
    return projector.derivatives(
        geometry, pose, pose_centre=pose_centre, by_pose=by_pose, shape=list(shape), density=list(density)
    )


def phantom(
    name: str = "femur", seed: int = 0, *, spacing: Any = (1.0, 1.0, 1.0), progress: Progress | None = None,
    **parameters: Any,
) -> tuple[Image, Image]:
    """CT (HU) and label map of an analytic bone, femur or hemipelvis. Parameters: PhantomImageSource."""
    f = _bonetk.PhantomImageSource()
    f.set_phantom(name, seed)
    f.spacing = spacing
    ct = _run(f, parameters, progress)
    return ct, _bonetk._detach(f.labels)


def train(
    subjects: dict[str, DensityMesh] | Sequence[DensityMesh], *, progress: Progress | None = None, **parameters: Any
) -> StatisticalModel:
    """An atlas of meshes of one topology. Parameters: StatisticalModelEstimator."""
    f = _bonetk.StatisticalModelEstimator()
    named = subjects if isinstance(subjects, dict) else {f"subject{i + 1}": mesh for i, mesh in enumerate(subjects)}
    for name, mesh in named.items():
        f.add_subject(name, mesh)
    return _run(f, parameters, progress)


def register_mesh(
    standard: DensityMesh, subject: DensityMesh, *, progress: Progress | None = None, **parameters: Any
) -> DensityMesh:
    """The standard model's topology on a subject's shape. Parameters: AtlasRegistrationFilter."""
    f = _bonetk.AtlasRegistrationFilter()
    f.standard = standard
    f.subject = subject
    return _run(f, parameters, progress)


Views = Sequence[tuple[Any, XRayGeometry]]


def _set_views(f: Any, views: Views, initial_transform: Any) -> None:
    for index, (radiograph, geometry, *weights) in enumerate(views):
        if isinstance(radiograph, np.ndarray) and radiograph.ndim == 2:
            radiograph = radiograph[np.newaxis]
        f.set_view(index, radiograph, geometry, *weights)
    if initial_transform is not None:
        f.set_initial_transform(initial_transform)


def register_rigid(
    model: DensityHierarchy | DensityMesh, views: Views, *, initial_transform: Any = None,
    progress: Progress | None = None, **parameters: Any,
) -> dict[str, Any]:
    """The pose of a density model in X-rays: the result of RigidRadiographRegistration, whose parameters these are.

    views: (radiograph, geometry) or (radiograph, geometry, weights) each; radiographs are images of line integrals, or
        arrays of rows x columns
    initial_transform: 4 x 4, from the model's space to the geometry's
    """
    f = _bonetk.RigidRadiographRegistration()
    f.model = DensityHierarchy([model]) if isinstance(model, DensityMesh) else model
    _set_views(f, views, initial_transform)
    _set(f, parameters)
    f.update(progress)
    return f.result()


def register_deformable(
    model: StatisticalModel, views: Views, *, initial_transform: Any = None, progress: Progress | None = None,
    **parameters: Any,
) -> tuple[DensityMesh, dict[str, Any]]:
    """The bone of an atlas that X-rays show, and the result of DeformableRadiographRegistration; see register_rigid."""
    f = _bonetk.DeformableRadiographRegistration()
    f.model = model
    _set_views(f, views, initial_transform)
    mesh = _run(f, parameters, progress)
    return mesh, f.result()


def register_volume(
    model: StatisticalModel, image: Any, *, progress: Progress | None = None, **parameters: Any
) -> tuple[DensityMesh, dict[str, Any]]:
    """The bone of an atlas in a CT, and the result of AtlasVolumeRegistration, whose parameters these are."""
    f = _bonetk.AtlasVolumeRegistration()
    f.image = as_image(image)
    f.model = model
    mesh = _run(f, parameters, progress)
    return mesh, f.result()
