"""Lists of mutants that are kept: which of them are needless takes a compilation of each."""

from __future__ import annotations

import _imp
import json
import os
import sys

from hrdsl.mutation.found import mutants

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any


def rows(file: str, cache: str | None) -> list[dict[str, Any]]:
    """All mutants of a file, marked, as JSON has them. `cache` is a folder; a list in it is for one text of the file, one version of the
    operators and one of Python."""
    with open(file, encoding="utf-8") as source:
        text = source.read()
    place = os.path.join(cache, "%s.json" % _name(text)) if cache else None
    if place:
        try:
            with open(place, encoding="utf-8") as there:
                return [{"file": file, **row} for row in json.load(there)]
        except (OSError, ValueError):
            pass
    found = [
        {"number": m.number, "line": m.line, "lines": m.lines, "operator": m.operator, "what": m.what, "needless": m.needless}
        for m in mutants(text, file)
    ]
    if place:
        _keep(found, place)
    return [{"file": file, **row} for row in found]


def _keep(found: list[dict[str, Any]], place: str) -> None:
    temporary = "%s.%d" % (place, os.getpid())
    try:
        with open(temporary, "w", encoding="utf-8") as out:
            json.dump(found, out, separators=(",", ":"))
        os.replace(temporary, place)
    except OSError:
        pass  # the next run makes it again


def _name(text: str) -> str:
    """For what the list holds: the text, the operators, the version of Python."""
    folder = os.path.dirname(os.path.abspath(__file__))
    parts = [sys.version, text]
    for name in sorted(name for name in os.listdir(folder) if name.endswith(".py")):
        with open(os.path.join(folder, name), encoding="utf-8") as own:
            parts.append(own.read())
    hashes = [_imp.source_hash(key, "\0".join(parts).encode()).hex() for key in (1, 2)]
    return "".join(hashes)
