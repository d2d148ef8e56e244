"""Puts functions in the place of the standard library's: at once, or when the module that has them is imported."""

import os
import sys

#: Which of the functions of `os` take descriptors or no symbolic links: other modules look themselves up there.
_ABILITIES = ("supports_dir_fd", "supports_effective_ids", "supports_fd", "supports_follow_symlinks")


class Builtin:
    """A function in the place of a built-in one. Like that, and unlike one written in Python, it does not become a
    method of a class that has it as an attribute; and it is pickled by its name."""

    def __init__(self, function, real, module):
        self._function = function
        self.__name__ = self.__qualname__ = real.__name__
        self.__module__ = module
        self.__doc__ = real.__doc__

    def __call__(self, *args, **kwargs):
        return self._function(*args, **kwargs)

    def __repr__(self):
        return "<built-in function %s>" % self.__name__

    def __reduce__(self):
        return self.__qualname__


def put(name, function, *modules):
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


def when_imported(name, patch):
    """Calls `patch` with the module of this name: now if it is there, otherwise as soon as it is imported. So modules
    that the program does not use cost it nothing."""
    if not _finder.patches:
        sys.meta_path.insert(0, _finder)
    _finder.patches[name] = patch
    if name in sys.modules:
        patch(sys.modules[name])


class _Finder:
    """Finds the modules that are to be patched, by asking the other finders."""

    def __init__(self):
        self.patches = {}

    def find_spec(self, name, path=None, target=None):
        patch = self.patches.get(name)
        if patch is None:
            return None
        for finder in sys.meta_path:
            find = None if finder is self else getattr(finder, "find_spec", None)
            spec = find and find(name, path, target)
            if spec is not None:
                if spec.loader is not None:
                    spec.loader = _Loader(spec.loader, patch)
                return spec
        return None


class _Loader:
    """A module's own loader, and then the patch; the module never sees it."""

    def __init__(self, loader, patch):
        self._loader = loader
        self._patch = patch

    def __getattr__(self, name):
        return getattr(self._loader, name)

    def create_module(self, spec):
        return self._loader.create_module(spec)

    def exec_module(self, module):
        module.__spec__.loader = module.__loader__ = self._loader
        self._loader.exec_module(module)
        self._patch(module)


_finder = _Finder()
