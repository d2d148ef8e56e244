"""What old scripts use."""

from __future__ import annotations

import rosgraph.names


def script_resolve_name(script_name: str, name: str) -> str:
    """The global name of a name that a script uses."""
    import warnings

    warnings.warn("Call to deprecated function script_resolve_name.", DeprecationWarning, stacklevel=2)
    return rosgraph.names.script_resolve_name(script_name, name)
