"""Puts functions in the place of the standard library's: at once, or when the module that has them is imported."""

from __future__ import annotations

import os
import sys

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from functools import partial as partial
    from types import ModuleType
    from typing import Any, Callable
else:
    from _functools import partial  # `functools` takes long to import

#: Which of the functions of `os` take descriptors or no symbolic links: other modules look themselves up there.
_ABILITIES = ("supports_dir_fd", "supports_effective_ids", "supports_fd", "supports_follow_symlinks")


class Builtin(partial):  # type: ignore[type-arg]
    """A function in the place of a built-in one. Like that, and unlike one written in Python, it does not become a
    method of a class that has it as an attribute; and it is pickled by its name."""

    def __new__(cls, function: Callable[..., Any], real: Any, module: str) -> Builtin:
        self: Any = super().__new__(cls, function)
        self.__name__ = self.__qualname__ = real.__name__
        self.__module__ = module
        self.__doc__ = real.__doc__
        made: Builtin = self
        return made

    def __get__(self, instance: object, owner: object = None) -> Builtin:
        return self

    def __repr__(self) -> str:
        return "<built-in function %s>" % self.__dict__["__name__"]

    def __reduce__(self) -> str:
        return str(self.__dict__["__qualname__"])


def put(name: str, function: Callable[..., Any], *modules: ModuleType) -> Any:
    """Puts a function in the place of the modules' own of this name, where they have one, and returns that."""
    real = getattr(modules[0], name, None)
    if real is None or isinstance(real, Builtin):
        return real
    replacement = Builtin(function, real, modules[0].__name__)
    for module in modules:
        setattr(module, name, replacement)
    if modules[0] is os:
        for ability in _ABILITIES:
            if real in getattr(os, ability, ()):
                getattr(os, ability).add(replacement)
    return real


def when_imported(name: str, patch: Callable[[ModuleType], object]) -> None:
    """Calls `patch` with the module of this name: now if it is there, otherwise as soon as it is imported. So modules
    that the program does not use cost it nothing."""
    if not _finder.patches:
        sys.meta_path.insert(0, _finder)
    _finder.patches[name] = patch
    if name in sys.modules:
        patch(sys.modules[name])


class _Finder:
    """Finds the modules that are to be patched, by asking the other finders."""

    def __init__(self) -> None:
        self.patches: dict[str, Callable[[ModuleType], object]] = {}

    def find_spec(self, name: str, path: Any = None, target: Any = None) -> Any:
        patch = self.patches.get(name)
        if patch is None:
            return None
        for finder in sys.meta_path:
            find = None if finder is self else getattr(finder, "find_spec", None)
            spec = find and find(name, path, target)
            if spec is not None:
                if spec.loader is not None and _is_of_python(spec):
                    spec.loader = _Loader(spec.loader, patch)
                return spec
        return None


def _is_of_python(spec: Any) -> bool:
    """A file of the program can have the name of a module of the library."""
    place = getattr(os, "__file__", None)
    origin: str = spec.origin or ""
    if place is None or not origin.endswith(".py"):
        return True
    stem = os.path.join(os.path.dirname(str(place)), *spec.name.split("."))
    return origin in (stem + ".py", os.path.join(stem, "__init__.py"))


class _Loader:
    """A module's own loader, and then the patch; the module never sees it."""

    def __init__(self, loader: Any, patch: Callable[[ModuleType], object]) -> None:
        self._loader = loader
        self._patch = patch

    def __getattr__(self, name: str) -> Any:
        return getattr(self._loader, name)

    def create_module(self, spec: Any) -> Any:
        return self._loader.create_module(spec)

    def exec_module(self, module: Any) -> None:
        module.__spec__.loader = module.__loader__ = self._loader
        self._loader.exec_module(module)
        self._patch(module)


_finder = _Finder()
