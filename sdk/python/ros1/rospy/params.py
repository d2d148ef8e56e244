"""Parameters: a tree of this program, which begins with those of the binding file."""

from __future__ import annotations

import copy

from rosgraph.names import is_global, is_legal_name, is_private, ns_join
from rospy.exceptions import ROSException
from rospy.names import get_mappings, get_name, resolve_name

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_UNSPECIFIED: Any = object()


class Tree:
    """Values by names with slashes."""

    def __init__(self, values: dict[str, Any]) -> None:
        self._root: dict[str, Any] = {}
        for name, value in values.items():
            self.set(name if is_global(name) else "/" + name, value)

    def get(self, key: str) -> Any:
        """The value, or the tree below; raises `KeyError`."""
        found: Any = self._root
        for part in _parts(key):
            if not isinstance(found, dict):
                raise KeyError(key)
            found = found[part]
        return copy.deepcopy(found)

    def has(self, key: str) -> bool:
        try:
            self.get(key)
        except KeyError:
            return False
        return True

    def set(self, key: str, value: Any) -> None:
        """Sets a value, or replaces the tree below by a dictionary."""
        parts, value = _parts(key), _copied(value)
        if not parts:
            if not isinstance(value, dict):
                raise TypeError("cannot set root of parameter tree to non-dictionary")
            self._root = value
            return
        place = self._root
        for part in parts[:-1]:
            inner = place.get(part)
            if not isinstance(inner, dict):
                inner = place[part] = {}
            place = inner
        place[parts[-1]] = value

    def delete(self, key: str) -> None:
        parts = _parts(key)
        place: Any = self._root
        for part in parts[:-1]:
            place = place[part]
            if not isinstance(place, dict):
                raise KeyError(key)
        if not parts:
            raise KeyError("cannot delete root of parameter tree")
        del place[parts[-1]]

    def names(self) -> list[str]:
        """Of all values."""
        found: list[str] = []

        def collect(prefix: str, place: dict[str, Any]) -> None:
            for name, value in place.items():
                if isinstance(value, dict):
                    collect(ns_join(prefix, name), value)
                else:
                    found.append(ns_join(prefix, name))

        collect("/", self._root)
        return found

    def search(self, ns: str, key: str) -> str | None:
        """The first that is there, from a namespace up; only the first part of the key must be."""
        if not key:
            return None
        if is_private(key):
            raise ROSException("cannot search for parameter: Internal failure: invalid key")
        if is_global(key):
            return key if self.has(key) else None
        parts = _parts(ns)
        for length in range(len(parts), -1, -1):
            place = "/" + "/".join(parts[:length])
            if self.has(ns_join(place, _parts(key)[0])):
                return ns_join(place, key)
        return None


def _parts(key: str) -> list[str]:
    return [part for part in key.split("/") if part]


def _copied(value: Any) -> Any:
    """As it is after it was sent; what cannot be sent is refused."""
    if isinstance(value, dict):
        for key in value:
            if not isinstance(key, str):
                raise TypeError("dictionary key must be string")
        return {key: _copied(inner) for key, inner in value.items()}
    if isinstance(value, (list, tuple)):
        return [_copied(inner) for inner in value]
    if type(value) in (bool, int, float, str, bytes):
        if type(value) is int and not -(1 << 31) <= value < 1 << 31:
            raise OverflowError("int exceeds XML-RPC limits")
        return value
    if value is None:
        raise TypeError("cannot marshal None unless allow_none is enabled")
    if hasattr(value, "__dict__") and not isinstance(value, (type, bool, int, float, str, bytes, list, tuple, dict)):
        return _copied(dict(value.__dict__))  # an object is sent as its attributes
    raise TypeError("cannot marshal %s objects" % type(value))


_tree: Tree | None = None


def tree() -> Tree:
    """The one of this program."""
    global _tree
    if _tree is None:
        from hrdsl.binding import binding

        _tree = Tree(binding().get("parameters", {}))
    return _tree


def get_param(param_name: str, default: Any = _UNSPECIFIED) -> Any:
    """The value of a parameter, or the dictionary of those below; raises `KeyError` if there is none and no default."""
    try:
        return tree().get(resolve_name(param_name))
    except KeyError:
        if default is not _UNSPECIFIED:
            return default
        raise KeyError(param_name) from None


get_param_cached = get_param


def get_param_names() -> list[str]:
    """The names of all parameters."""
    return tree().names()


def set_param(param_name: str, param_value: Any) -> None:
    """Sets a parameter; of a dictionary, those below."""
    if not is_legal_name(param_name):
        import warnings

        text = "'%s' is not a legal ROS graph resource name. This may cause problems with other ROS tools"
        warnings.warn(text % param_name, stacklevel=2)
    tree().set(resolve_name(param_name), param_value)


def search_param(param_name: str) -> str | None:
    """The global name of a parameter that is looked for from the node's own namespace up."""
    return tree().search(get_name(), get_mappings().get(param_name, param_name))


def delete_param(param_name: str) -> None:
    """Removes a parameter; raises `KeyError` if there is none."""
    try:
        tree().delete(resolve_name(param_name))
    except KeyError:
        raise KeyError(param_name) from None


def has_param(param_name: str) -> bool:
    """Whether there is such a parameter."""
    return tree().has(resolve_name(param_name))
