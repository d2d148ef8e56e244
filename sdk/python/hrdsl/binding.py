"""What hrdsl tells the program's libraries of the scenario: the file named by `HRDSL_BINDING`, a JSON object."""

from __future__ import annotations

import json
import os

from hrdsl.errors import ProtocolError

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any

_read: dict[str, Any] | None = None


def binding() -> dict[str, Any]:
    """All of it; empty if there is no such file. It is read once."""
    global _read
    if _read is None:
        path = os.environ.get("HRDSL_BINDING")
        if not path:
            return {}
        try:
            with open(path, encoding="utf-8") as file:
                found = json.load(file)
        except (OSError, ValueError) as error:
            raise ProtocolError("the file of HRDSL_BINDING cannot be read: %s" % error) from None
        if not isinstance(found, dict):
            raise ProtocolError("the file of HRDSL_BINDING is no JSON object: %s" % path)
        _read = found
    return _read
