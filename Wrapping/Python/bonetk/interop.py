"""Meshes to and from VTK and meshio, and what notebooks show."""
from __future__ import annotations

import base64
import html
from typing import Any

from ._bonetk import DensityMesh, UsageError

# Names of the arrays in .vtu files, of points and of cells.
_POINT_ARRAYS = {"layer": "Layer", "slice": "Slice"}
_CELL_ARRAYS = {"region": "Region", "degree": "Degree", "coefficients": "DensityCoefficients"}
_QUANTITIES = ["unknown", "hu", "k2hpo4", "ha", "ash", "apparent"]
_VTK_TETRA = 10


def to_vtk(self: DensityMesh) -> Any:
    """The mesh as a vtkUnstructuredGrid with the arrays of .vtu files. A copy."""
    import numpy as np
    from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray
    from vtkmodules.vtkCommonCore import vtkPoints
    from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkUnstructuredGrid

    grid = vtkUnstructuredGrid()
    points = vtkPoints()
    points.SetData(numpy_to_vtk(self.points, deep=True))
    grid.SetPoints(points)
    cells = vtkCellArray()
    count = 0 if self.tetrahedra is None else len(self.tetrahedra)
    if count:
        cells.SetData(
            numpy_to_vtkIdTypeArray(np.arange(0, 4 * count + 1, 4, dtype=np.int64), deep=True),
            numpy_to_vtkIdTypeArray(self.tetrahedra.astype(np.int64).ravel(), deep=True),
        )
    grid.SetCells(_VTK_TETRA, cells)
    for data, names in ((grid.GetPointData(), _POINT_ARRAYS), (grid.GetCellData(), _CELL_ARRAYS)):
        for name, vtk_name in names.items():
            values = getattr(self, name)
            if values is not None:
                array = numpy_to_vtk(values, deep=True)
                array.SetName(vtk_name)
                data.AddArray(array)
    quantity = numpy_to_vtk(np.array([_QUANTITIES.index(self.quantity)], dtype=np.int32), deep=True)
    quantity.SetName("DensityQuantity")
    grid.GetFieldData().AddArray(quantity)
    return grid


def from_vtk(grid: Any) -> DensityMesh:
    """The mesh of a vtkUnstructuredGrid of linear tetrahedra, with those of the arrays of .vtu files that it has."""
    import numpy as np
    from vtkmodules.util.numpy_support import vtk_to_numpy

    types = vtk_to_numpy(grid.GetCellTypesArray()) if grid.GetNumberOfCells() else np.zeros(0)
    if not len(types) or (types != _VTK_TETRA).any():
        raise UsageError("the grid must consist of linear tetrahedra (VTK_TETRA)")
    found = {}
    for data, names in ((grid.GetPointData(), _POINT_ARRAYS), (grid.GetCellData(), _CELL_ARRAYS)):
        for name, vtk_name in names.items():
            if data.HasArray(vtk_name):
                found[name] = vtk_to_numpy(data.GetArray(vtk_name))
    if "coefficients" in found:
        found["coefficients"] = found["coefficients"].reshape(len(types), -1)
    else:
        found.pop("degree", None)
    if grid.GetFieldData().HasArray("DensityQuantity"):
        found["quantity"] = _QUANTITIES[int(vtk_to_numpy(grid.GetFieldData().GetArray("DensityQuantity"))[0])]
    tetrahedra = vtk_to_numpy(grid.GetCells().GetConnectivityArray()).reshape(-1, 4)
    return DensityMesh(vtk_to_numpy(grid.GetPoints().GetData()), tetrahedra, **found)


def to_meshio(self: DensityMesh) -> Any:
    """The mesh as a meshio.Mesh with the arrays of .vtu files; points and tetrahedra are shared, not copied."""
    import meshio

    def arrays(names: dict[str, str]) -> dict[str, Any]:
        return {vtk_name: getattr(self, name) for name, vtk_name in names.items() if getattr(self, name) is not None}

    return meshio.Mesh(
        self.points,
        [("tetra", self.tetrahedra)],
        point_data=arrays(_POINT_ARRAYS),
        cell_data={name: [values] for name, values in arrays(_CELL_ARRAYS).items()},
    )


def _repr_html_(self: DensityMesh) -> str:
    picture = base64.b64encode(self._shade(240)).decode("ascii")
    image = f'<img alt="the surface from the front" src="data:image/png;base64,{picture}">' if picture else ""
    return f"<div>{image}<p>{html.escape(repr(self))}</p></div>"


# The methods of the class that are Python; assignments to methods are none for type checkers.
for _name, _method in {
    "to_vtk": to_vtk, "from_vtk": staticmethod(from_vtk), "to_meshio": to_meshio, "_repr_html_": _repr_html_
}.items():
    setattr(DensityMesh, _name, _method)
