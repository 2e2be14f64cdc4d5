"""The face of a package: the names that others import from it, read from its `__init__`."""

import ast
from functools import cache
from pathlib import Path
from types import ModuleType


@cache  # tests ask at every import
def face_of(module: ModuleType) -> list[str]:
    """Constants, classes and functions of a face, each in order of the alphabet.

    They are what `__init__` imports `as` the same name, which exports it (PEP 484), and what it
    defines without an underscore, but for the list of the parts of a room.
    """
    tree = ast.parse(Path(str(module.__file__)).read_text(encoding="utf-8"))
    names: set[str] = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom):
            names |= {alias.name for alias in node.names if alias.asname == alias.name}
    for node in tree.body:
        match node:
            case ast.FunctionDef(name=name) | ast.ClassDef(name=name):
                names.add(name)
            case ast.Assign(targets=[target]) | ast.AnnAssign(target=target):
                names |= {n.id for n in ast.walk(target) if isinstance(n, ast.Name)}
    return sorted((n for n in names - {"PARTS"} if not n.startswith("_")), key=rank)


def rank(name: str) -> tuple[int, str]:
    """Place of a name in a face; one capital alone is a class."""
    if name.isupper() and len(name) > 1:
        return 0, name
    return (1 if name[0].isupper() else 2), name
