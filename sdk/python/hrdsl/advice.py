"""What to do about a module that robot code did not find, in a line."""

from __future__ import annotations

import os
import sys

# Of a project's files and folders: a search must not take longer than the test.
LOOKED_AT = 5000
NOT_OURS = ("__pycache__", "build", "hrdsl-out", "node_modules")


def about(error: ImportError) -> str | None:
    """The line for a `ModuleNotFoundError`, or None."""
    if not error.name:
        return None
    name, _, inner = error.name.partition(".")
    if inner:
        return _inside(name, inner)
    if name in getattr(sys, "stdlib_module_names", ()):
        return "`%s` belongs to Python, but %s came without it: install it there" % (name, sys.executable)
    place = _in_project(name)
    if place is None:
        return "put `%s` into requirements.txt beside the scenario (or the package that has it)" % name
    project = _project_of(place)
    if project:
        return "`%s` is at %s: put `%s` into requirements.txt beside the scenario" % (name, place, project)
    folder = os.path.dirname(place) or "."
    advice = '`%s` is at %s, where no module is looked for: add `sys.path.append("%s")` before the import'
    return advice % (name, place, folder)


def _inside(name: str, inner: str) -> str | None:
    """About a module of a package that was found."""
    package = sys.modules.get(name)
    place = getattr(package, "__file__", None)
    if place:
        return "`%s` at %s has no module `%s`: is it the one you mean, and new enough?" % (name, place, inner)
    # A folder without code of its own is taken for a package, as the folder of a project may be.
    for folder in getattr(package, "__path__", ()):
        project = _project_of(os.path.join(os.path.relpath(folder), inner))
        if project:
            advice = "%s is the folder of a project: put `%s` into requirements.txt beside the scenario"
            return advice % (folder, project)
    return None


def _in_project(name: str) -> str | None:
    """The path of a module or package below the scenario's folder."""
    looked_at = 0
    for folder, folders, files in os.walk("."):
        if "pyvenv.cfg" in files:
            folders[:] = []
            continue
        looked_at += len(folders) + len(files)
        if looked_at > LOOKED_AT:
            return None
        folders[:] = sorted(f for f in folders if not f.startswith(".") and f not in NOT_OURS)
        if name + ".py" in files:
            return os.path.relpath(os.path.join(folder, name + ".py"))
        if name in folders and any(f.endswith(".py") for f in os.listdir(os.path.join(folder, name))):
            return os.path.relpath(os.path.join(folder, name))
    return None


def _project_of(place: str) -> str | None:
    """The folder above that pip can install, as requirements name it."""
    folder = os.path.dirname(place)
    while folder:
        if any(os.path.isfile(os.path.join(folder, file)) for file in ("pyproject.toml", "setup.py")):
            return "./" + folder
        folder = os.path.dirname(folder)
    return None
