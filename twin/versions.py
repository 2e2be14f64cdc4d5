"""What a result depends on: versions of the package, of the libraries and of the file formats."""

import platform
from importlib.metadata import PackageNotFoundError, version

LIBRARIES = (
    "numpy",
    "scipy",
    "build123d",
    "cadquery-ocp-novtk",
    "trimesh",
    "manifold3d",
    "pyvista",
)
FORMATS = ("machine/1", "errors/1", "run/1", "standard/1", "model/2", "project/1", "diagnosis/1")


def versions() -> dict[str, str]:
    """Name and version of everything that a figure depends on."""
    found = {
        "material-standard": _version("material-standard"),
        "Python": platform.python_version(),
    }
    found |= {name: _version(name) for name in LIBRARIES}
    return found | {"formats": ", ".join(FORMATS)}


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return "not installed"
