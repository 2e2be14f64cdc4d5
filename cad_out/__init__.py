"""From a standard to its CAD files, measured before they get their names.

In: a `Standard` of `matstd.artefact.body`, whose limits the caller has checked. Out:
`standard.step` (AP242: body, balls and screws, named faces), `standard.stl`, `.3mf` and `.glb` in a
folder, and a `Conformity` of all that was measured on them; or a `NotBuildable` that names the
figure beyond its limit, and no file.

The CAD kernel runs in a process of its own (`kernel`), because a crash of it ends its process.
`verify` re-reads the files: by the kernel, by a reader of the STEP text without kernel, and by two
mesh libraries. Workshop details (seats of the balls, pads, datum sides, lettering) follow by rule
in `details`; `triangles` makes triangles without needles, `meshes` measures and writes them. A new
file format is written in `kernel` beside `exchange` and gets its figures in `verify.conformity`.
"""

PARTS = ("details", "making", "triangles", "meshes", "kernel", "verify")
"""From bottom to top: each imports only from those before it."""
