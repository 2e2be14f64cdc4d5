"""First mode, balls and sag of a designed standard by another finite-element program.

    python -m venv fem && fem/bin/pip install scikit-fem gmsh meshio scipy
    fem/bin/python benchmarks/stiffness_judge.py OUT [--size 14] [--post 5]

OUT is a folder of `matstd design`. gmsh meshes the body of its `standard.step` (the exported solid,
with posts, blends and pads, not the description from which `making.json` was computed) into
quadratic tetrahedra, scikit-fem assembles them, and nothing of this project is imported. The body
is held on the lower faces of its pads; every ball is a rigid mass on the end of its post.
"""

import argparse
import json
import tomllib
from pathlib import Path

import gmsh
import numpy as np
from scipy.sparse import coo_array, csc_array
from scipy.sparse.linalg import LinearOperator, eigsh, splu
from skfem import Basis, BilinearForm, ElementTetP2, ElementVector, MeshTet
from skfem.helpers import ddot, dot, sym_grad, trace
from skfem.models.elasticity import lame_parameters

BALL_DENSITY = 7.83e-6  # kg/mm^3
GRAVITY = 9.81  # N/kg


def mesh_of(path, size, post, balls):
    """Quadratic tetrahedra of the largest solid of a STEP file, fine in the posts."""
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.option.setString("Geometry.OCCTargetUnit", "MM")
    gmsh.model.occ.importShapes(str(path))
    gmsh.model.occ.synchronize()
    volumes = gmsh.model.getEntities(3)
    body = max(volumes, key=lambda v: gmsh.model.occ.getMass(*v))
    gmsh.model.occ.remove([v for v in volumes if v != body], recursive=True)
    gmsh.model.occ.synchronize()
    numbers = []
    for ball in balls:
        x, y, z = ball["centre_mm"]
        foot = ball["foot_mm"]
        n = gmsh.model.mesh.field.add("Cylinder")
        for key, value in (
            ("VIn", post), ("VOut", size), ("Radius", ball["foot_radius_mm"] + 2.0),
            ("XCenter", x), ("YCenter", y), ("ZCenter", 0.5 * (foot + z)),
            ("XAxis", 0.0), ("YAxis", 0.0), ("ZAxis", 0.5 * (z - foot) + 4.0),
        ):  # fmt: skip
            gmsh.model.mesh.field.setNumber(n, key, value)
        numbers.append(n)
    least = gmsh.model.mesh.field.add("Min")
    gmsh.model.mesh.field.setNumbers(least, "FieldsList", numbers)
    gmsh.model.mesh.field.setAsBackgroundMesh(least)
    for key in ("MeshSizeExtendFromBoundary", "MeshSizeFromPoints", "MeshSizeFromCurvature"):
        gmsh.option.setNumber(f"Mesh.{key}", 0)
    gmsh.option.setNumber("Mesh.Algorithm3D", 10)
    gmsh.model.mesh.generate(3)
    tags, places, _ = gmsh.model.mesh.getNodes()
    index = {tag: i for i, tag in enumerate(tags)}
    _, elements = gmsh.model.mesh.getElementsByType(4)
    cells = np.array([index[t] for t in elements]).reshape(-1, 4)
    gmsh.finalize()
    used, cells = np.unique(cells, return_inverse=True)
    return MeshTet(places.reshape(-1, 3)[used].T, cells.reshape(-1, 4).T)


@BilinearForm
def weight(u, v, w):
    """Mass per density."""
    return dot(u, v)


def stiffness(young, poisson):
    """Isotropic elasticity."""
    lame, shear = lame_parameters(young, poisson)

    @BilinearForm
    def form(u, v, w):
        strain = sym_grad(u)
        return 2.0 * shear * ddot(strain, sym_grad(v)) + lame * trace(strain) * trace(sym_grad(v))

    return form


def main():
    """Print the figures of both programs side by side."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--size", type=float, default=14.0, help="elements of the plate, mm")
    parser.add_argument("--post", type=float, default=5.0, help="elements of the posts, mm")
    args = parser.parse_args()
    standard = tomllib.loads((args.folder / "standard.toml").read_text())
    ours = json.loads((args.folder / "making.json").read_text())
    balls, density = standard.get("sphere", []), standard["material"]["density_kg_mm3"]
    mesh = mesh_of(args.folder / "standard.step", args.size, args.post, balls)
    basis = Basis(mesh, ElementVector(ElementTetP2()))
    K = stiffness(ours["modulus_MPa"], ours["poisson"]).assemble(basis).tocoo()
    M = (density * weight.assemble(basis)).tocoo()
    places = basis.doflocs
    n = K.shape[0]
    node = np.unique(places.T, axis=0, return_inverse=True)[1]  # three components of one place
    held = held_dofs(standard, places)
    # balls: rigid, carried by the end of the post, six degrees of freedom each behind the body's
    size = n + 6 * len(balls)
    rows, cols, values = [K.row], [K.col], [K.data]
    rowsM, colsM, valuesM = [M.row], [M.col], [M.data]
    for k, ball in enumerate(balls):
        centre = np.array(ball["centre_mm"])
        low = centre[2] - 1.05 * ball["radius_mm"]
        end = np.flatnonzero(
            (np.hypot(*(places[:2] - centre[:2, None])) < 1.2 * ball["stem_radius_mm"])
            & (places[2] > low)
        )
        assert len(end) > 30, ball["name"]
        tip = n + 6 * k + np.arange(6)
        mass = BALL_DENSITY * 4.0 / 3.0 * np.pi * ball["radius_mm"] ** 3
        rowsM.append(tip)
        colsM.append(tip)
        valuesM.append([mass] * 3 + [0.4 * mass * ball["radius_mm"] ** 2] * 3)
        component = np.arange(n)[end] % 3
        for dof, axis in zip(end, component, strict=True):
            arm = places[:, dof] - centre
            row = np.zeros(6)
            row[axis] = 1.0
            row[3:] = np.cross(np.eye(3), arm)[:, axis]
            J = np.concatenate([[1.0], -row])
            at = np.concatenate([[dof], tip])
            rows.append(np.repeat(at, 7))
            cols.append(np.tile(at, 7))
            values.append(1e7 * np.outer(J, J).reshape(-1))
    del node
    rows.append(held)
    cols.append(held)
    values.append(np.full(len(held), 1e9))
    K = csc_array(coo_array((np.concatenate(values), (np.concatenate(rows), np.concatenate(cols))),
                            shape=(size, size)))  # fmt: skip
    M = csc_array(coo_array((np.concatenate(valuesM), (np.concatenate(rowsM),
                             np.concatenate(colsM))), shape=(size, size)))  # fmt: skip
    print(f"{mesh.t.shape[1]} tetrahedra, {size} degrees of freedom", flush=True)
    factor = splu(K, permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True})
    inverse = LinearOperator((size, size), matvec=factor.solve)
    found = eigsh(K, k=1, M=M, sigma=0.0, OPinv=inverse, v0=np.ones(size))[0]
    mode = float(np.sqrt(found[0] * 1e3) / (2.0 * np.pi))
    report("first mode, Hz", mode, ours["first_mode_Hz"])
    pull = np.zeros((size, 3))
    for axis in range(3):
        pull[axis:n:3, axis] = 1.0
        pull[n + axis :: 6, axis] = 1.0
    moved = factor.solve(M @ pull * GRAVITY) * 1e3  # um
    for k, ball in enumerate(balls):
        at = n + 6 * k
        unit = np.zeros((size, 3))
        unit[at : at + 3] = np.eye(3)
        soft = np.linalg.eigvalsh(factor.solve(unit)[at : at + 3])[-1]
        name = ball["name"]
        report(f"{name}, N/um", 1e-3 / soft, ours["ball_N_um"][name])
        angle = np.linspace(0.0, 2.0 * np.pi, 25)
        across = np.column_stack([np.cos(angle), np.sin(angle), np.ones(25)])
        sag = np.linalg.norm(across @ moved[at : at + 3].T, axis=1).max()
        report(f"{name}, sag in um", sag, ours["sag_um"][name])


def held_dofs(standard, places):
    """Degrees of freedom of the lower faces of the pads round the screws."""
    lowest = places[2].min()
    out = [
        np.flatnonzero(
            (np.hypot(places[0] - hole["x_mm"], places[1] - hole["y_mm"]) < 3.0 * hole["radius_mm"])
            & (places[2] < lowest + 1e-6)
        )
        for hole in standard.get("hole", [])
    ]
    return np.unique(np.concatenate(out))


def report(name, theirs, ours):
    """One line."""
    print(f"{name:20s} scikit-fem {theirs:9.3f}  making.json {ours:9.3f}  {ours / theirs:6.3f}",
          flush=True)  # fmt: skip


if __name__ == "__main__":
    main()
