"""Functions in memory. Their further keywords are the parameters of the filters that they run, see each filter's help."""
from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Protocol, TypeVar, Union

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

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

Progress = Callable[[float], object]


_Output = TypeVar("_Output", covariant=True)


class _Source(Protocol[_Output]):
    """A filter with one output."""

    def update(self, progress: Progress | None) -> None: ...

    @property
    def output(self) -> _Output: ...


def _set(filter_: Any, parameters: dict[str, Any]) -> None:
    for name, value in parameters.items():
        if name not in filter_.parameter_names:
            raise UsageError(
                f'{type(filter_).__name__} has no parameter "{name}"; it has ' + ", ".join(sorted(filter_.parameter_names))
            )
        setattr(filter_, name, value)


def _run(filter_: _Source[_Output], parameters: dict[str, Any], progress: Progress | None) -> _Output:
    """Runs a filter and hands out its output, which is then its own."""
    _set(filter_, parameters)
    filter_.update(progress)
    return _bonetk._detach(filter_.output)


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
    numbers: list[Any] = [round(level * count) if level < 1 else level for level in levels]
    f.levels = numbers
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
    radiograph: Image = _run(f, parameters, progress)
    return radiograph


def drr_vjp(
    mesh: DensityMesh, geometry: XRayGeometry, pose: Any = None, *, pose_centre: Any = None, **parameters: Any
) -> tuple[npt.NDArray[np.float32], Callable[[Any], dict[str, npt.NDArray[np.float64]]]]:
    """The radiograph (rows x columns) and a function from derivatives by its pixels to derivatives by the model.

    The function takes rows x columns numbers and gives a dict of ``pose`` (6; per mm, per radian), ``points`` (n x 3, per
    mm) and ``coefficients`` (m x k). pose and further keywords: see Projector, which is faster for many calls.
    """
    return Projector(mesh, keep=False, **parameters).vjp(geometry, pose, pose_centre=pose_centre)


def drr_derivatives(
    mesh: DensityMesh, geometry: XRayGeometry, pose: Any = None, *, pose_centre: Any = None, by_pose: bool = True,
    shape: Sequence[Any] = (), density: Sequence[Any] = (), **parameters: Any,
) -> tuple[npt.NDArray[np.float32], npt.NDArray[np.float32]]:
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
    subjects: dict[str, DensityMesh] | Sequence[DensityMesh], *, atlas: StatisticalModel | None = None,
    progress: Progress | None = None, **parameters: Any,
) -> StatisticalModel:
    """An atlas of meshes of one topology, or one with these added to it. Parameters: StatisticalModelEstimator."""
    f = _bonetk.StatisticalModelEstimator()
    if atlas is not None:
        f.atlas = atlas
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


Views = Sequence[Union[tuple[Any, XRayGeometry], tuple[Any, XRayGeometry, Any]]]


def _set_views(f: Any, views: Views, initial_transform: Any) -> None:
    for index, (radiograph, *others) in enumerate(views):
        if not isinstance(radiograph, Image) and getattr(radiograph, "ndim", 3) == 2:
            radiograph = radiograph[None]
        f.set_view(index, radiograph, *others)
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


Landmarks = Mapping[str, Any]


def measure(
    mesh: DensityMesh, landmarks: Landmarks | None = None, *, standard: DensityMesh | None = None, balls: Any = (),
    cylinders: Any = (), capsules: Any = (), half_spaces: Any = (), **parameters: Any,
) -> dict[str, Any]:
    """Measures of a model, as ``bonetk measure`` writes them: a dict of landmarks, measures and missing.

    landmarks: name and point (mm) each; with those of a femur or a hemipelvis come that bone's measures
    standard: model of the mesh's topology that the landmarks lie on; they are carried to the mesh
    balls: x y z radius each, mm
    cylinders, capsules: x y z of one end, x y z of the other, radius each, mm
    half_spaces: x y z of a point of the plane (mm), x y z into it each
    Parameters: solid_error (share), landmark_reach (mm).
    """
    return _bonetk._measure(mesh, dict(landmarks or {}), standard, balls, cylinders, capsules, half_spaces, **parameters)


def plan(
    mesh: DensityMesh, *, resections: Any = (), paths: Any = (), radius: float = 0.0, search: bool = False,
    **parameters: Any,
) -> dict[str, Any]:
    """Resections and paths of screws, as ``bonetk plan`` writes them: a dict of measures and missing.

    resections: x y z of a point of the plane (mm), x y z toward what is removed each
    paths: x y z where it enters, x y z where it ends each, mm; radius: of all paths, mm
    search: takes the safe path with the densest bone around it near each path given
    Parameters: margin, shell, search_shift, search_depth (mm), search_angle (radians).
    """
    return _bonetk._plan(mesh, resections, paths, radius, search, **parameters)


def evaluate(
    mesh: DensityMesh, model: StatisticalModel, *, ct: Any = None, progress: Progress | None = None, **parameters: Any
) -> dict[str, Any]:
    """A subject against an atlas, as ``bonetk evaluate`` writes it: a dict of shape, density, registered and more.

    ct: the subject's CT, for its density; None: the mesh's own
    Parameters: AtlasRegistrationFilter, which brings a mesh of another topology onto the atlas'.
    """
    return _bonetk._evaluate(mesh, model, None if ct is None else as_image(ct), progress, **parameters)


def export(
    mesh: DensityMesh, law: str, path: str | os.PathLike[str] = "", *, format: str = "abaqus",
    landmarks: Landmarks | None = None, line: tuple[float, float] | None = None, surface: Any = None, **parameters: Any,
) -> dict[str, Any]:
    """Finite elements with materials and sets of a model in ash or apparent density, as arrays and as a solver's file.

    law: Young's modulus by density, see elasticity_laws
    path: file to write as ``bonetk export`` does; empty: none. format: abaqus, calculix, febio, gmsh or vtk
    landmarks: name and point (mm) each, a node set LM_NAME of the next node
    line: intercept and slope of the law's density (g/cm3) by HU, for a model in HU
    surface: finer DensityMesh, or points (n x 3) and triangles (t x 3), that nodes on the boundary's edges are moved onto
    Parameters: order, bins, modulus_field (bins, cells, nodes), least_modulus (MPa), poisson_ratio.

    The dict has nodes (n x 3, mm), elements (m x 10 or 4), region, modulus (MPa), mass_density (t/mm3) and material of
    each element, node_modulus, materials, node_sets, element_sets, exterior (faces by their nodes) and more.
    """
    return _bonetk._export(mesh, law, dict(landmarks or {}), line, surface, os.fspath(path), format, **parameters)
