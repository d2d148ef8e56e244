"""Puts the code of a mutant in the place of a file's own: in the process that runs it, without writing a file.

HRDSL_MUTANT says which, as JSON: `{"file": "robot.py", "code": "/…/17.code"}`, the file from the program's folder, and the mutant compiled
beforehand (`hrdsl.mutation.codes`). So a fork server serves runs of any mutant, and none of them compiles anything.
"""

from __future__ import annotations

import _imp
import marshal
import os
import sys

# As `importlib.util` has it; to import that while modules are searched for would search for it here.
from _frozen_importlib_external import spec_from_file_location  # type: ignore[import-not-found]

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    import types
    from typing import Any, Sequence

#: The variable that names the mutant.
VARIABLE = "HRDSL_MUTANT"


class Switch:
    """Gives the mutated code for the module that is in the file: a finder of modules, and their loader."""

    def __init__(self, file: str, compiled: types.CodeType) -> None:
        self.file = os.path.realpath(file)
        self.compiled = compiled
        self.is_used = False

    def code_for(self, path: str) -> types.CodeType | None:
        """The code, if it is that of the file at this path."""
        if os.path.realpath(path) != self.file:
            return None
        self.is_used = True
        _imp._fix_co_filename(self.compiled, path)  # tracebacks and coverage name the file as the original does
        return self.compiled

    def find_spec(self, name: str, path: Sequence[str] | None, target: types.ModuleType | None = None) -> Any:
        stem, _ = os.path.splitext(os.path.basename(self.file))
        last = name.rpartition(".")[2]
        is_package = stem == "__init__"
        if last != (os.path.basename(os.path.dirname(self.file)) if is_package else stem):
            return None
        inner = os.path.join(last, "__init__.py") if is_package else stem + ".py"
        for folder in sys.path if path is None else path:
            if os.path.realpath(os.path.join(folder or ".", inner)) == self.file:
                inside = [os.path.dirname(self.file)] if is_package else None
                loader: Any = self
                return spec_from_file_location(name, self.file, loader=loader, submodule_search_locations=inside)
        return None

    def create_module(self, spec: object) -> None:
        return None

    def exec_module(self, module: types.ModuleType) -> None:
        exec(self.get_code(module.__name__), module.__dict__)  # the program's own code

    def get_code(self, name: str) -> types.CodeType:
        """As `runpy` asks for it, which runs a module as a program."""
        self.is_used = True
        _imp._fix_co_filename(self.compiled, self.file)
        return self.compiled

    def is_package(self, name: str) -> bool:
        return os.path.basename(self.file) == "__init__.py"


def chosen(words: str) -> Switch:
    """The switch for what the variable says. The program's folder is the current one."""
    import json

    given = json.loads(words)
    with open(given["code"], "rb") as file:
        compiled = marshal.loads(file.read())
    return Switch(given["file"], compiled)
