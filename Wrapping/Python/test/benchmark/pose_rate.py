"""Radiographs with derivatives by pose a second, in Python and by scipy.optimize, beside the same calls in C++.

pose_rate.py BONE_POSE_RATE [CALLS]: the program bonePoseRate (cmake --build ... --target bonePoseRate). Level 3 of a
phantom's model, 256 x 256 pixels. Run it on an idle machine.
"""
import os
import subprocess
import sys
import tempfile
import time

import numpy as np
from scipy.optimize import minimize

import bonetk


def main():
    program = sys.argv[1]
    calls = int(sys.argv[2]) if len(sys.argv) > 2 else 200
    ct, regions = bonetk.phantom("femur", spacing=(1.5, 1.5, 1.5))
    labels = bonetk.Image((regions.array > 0).astype(np.int16), regions.origin, regions.spacing, regions.direction)
    model = bonetk.build(ct, labels)
    mesh = model[2]
    lower, upper = mesh.points.min(axis=0) - 5, mesh.points.max(axis=0) + 5
    size = (upper - lower).max()
    middle = (lower + upper) / 2
    view = bonetk.XRayGeometry.framing(middle - size / 2, middle + size / 2, pixels=256)
    print(mesh, view.size)
    projector = bonetk.Projector(mesh)

    with tempfile.TemporaryDirectory() as folder:
        vtu, geometry = os.path.join(folder, "m.vtu"), os.path.join(folder, "g.json")
        bonetk.write_mesh(mesh, vtu)
        bonetk.write_geometry([view], geometry)
        print("C++:\n" + subprocess.run([program, vtu, geometry, str(calls)], check=True, capture_output=True, text=True).stdout)

    start = time.perf_counter()
    for i in range(calls):
        image = projector(view, [0.01 * i, 0, 0, 0, 0, 0])
    print(f"Python:\nvalue: {calls / (time.perf_counter() - start):.1f} a second")
    start = time.perf_counter()
    for i in range(calls):
        image, pullback = projector.vjp(view, [0.01 * i, 0, 0, 0, 0, 0])
        pullback(image)
    print(f"value and gradient: {calls / (time.perf_counter() - start):.1f} a second")

    wanted = projector(view, [3, -2, 1, 0.05, -0.03, 0.04])
    evaluations = 0

    def cost(pose):
        nonlocal evaluations
        evaluations += 1
        image, pullback = projector.vjp(view, pose)
        error = image - wanted
        return float(np.vdot(error, error)) / error.size / 1e6, pullback(error * (2e-6 / error.size))["pose"]

    start = time.perf_counter()
    while evaluations < calls:
        found = minimize(cost, np.zeros(6), jac=True, method="BFGS")
    print(f"scipy.optimize: {evaluations / (time.perf_counter() - start):.1f} values and gradients a second")
    print("pose found:", np.round(found.x, 3))


if __name__ == "__main__":
    main()
