"""From a standard to its CAD files, measured before they get their names.

In: a `Standard` of `matstd.artefact.body`, whose limits the caller has checked. Out:
`standard.step` (AP242: body, balls and screws, named faces), `standard.stl`, `.3mf` and `.glb` in a
folder, and a `Conformity` of all that was measured on them; or a `NotBuildable` that names the
figure out of its limit, and no file.

The CAD kernel runs in a process of its own (`build`), because its faults end the process they run
in. `verify` reads the files anew: by the kernel, by a reader of the STEP text that knows no kernel,
and by two mesh libraries. What a workshop adds to the design (seats of the balls, pads,
datum sides, lettering) follows by rule in `details`; `triangles` makes triangles without
needles, `meshes` measures and writes them. Another file format
is written in `build` beside `exchange` and gets its own figures in `verify.conformity`.
"""

PARTS = ("details", "making", "triangles", "meshes", "kernel", "verify")
"""From bottom to top: each imports only from those before it."""
