"""Parameters: one tree for all programs of the system, which the harness has. It begins with those of the binding.

What JSON has no value for is an object whose only key no name has: `{"/float": "nan"}`, `{"/bytes": "AAE="}`.
"""

from __future__ import annotations

from hrdsl.exchange import the_exchange
from rosgraph.names import is_global, is_legal_name, is_private, ns_join
from rospy.exceptions import ROSException
from rospy.names import get_mappings, get_name, resolve_name

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_UNSPECIFIED: Any = object()


class Tree:
    """Values by names with slashes."""

    def get(self, key: str) -> Any:
        """The value, or the tree below; raises `KeyError`."""
        exchange = the_exchange()
        exchange.polled("parameter")
        answer = exchange.link.request({"request": "get_parameter", "name": key})
        if "value" not in answer:
            raise KeyError(key)
        return _decoded(answer["value"])

    def has(self, key: str) -> bool:
        try:
            self.get(key)
        except KeyError:
            return False
        return True

    def set(self, key: str, value: Any) -> None:
        """Sets a value, or replaces the tree below by a dictionary."""
        value = _encoded(value)
        if not _parts(key) and not isinstance(value, dict):
            raise TypeError("cannot set root of parameter tree to non-dictionary")
        the_exchange().link.request({"request": "set_parameter", "name": key, "value": value})

    def delete(self, key: str) -> None:
        """Removes a value, or the tree below; raises `KeyError`."""
        if not the_exchange().link.request({"request": "delete_parameter", "name": key})["ok"]:
            raise KeyError(key)

    def names(self) -> list[str]:
        """Of all values."""
        found: list[str] = []

        def collect(prefix: str, place: dict[str, Any]) -> None:
            for name, value in place.items():
                if isinstance(value, dict):
                    collect(ns_join(prefix, name), value)
                else:
                    found.append(ns_join(prefix, name))

        collect("/", self.get("/"))
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


def _encoded(value: Any) -> Any:
    """As it is sent; what cannot be sent is refused, as XML-RPC does."""
    if isinstance(value, dict):
        for key in value:
            if not isinstance(key, str):
                raise TypeError("dictionary key must be string")
        return {key: _encoded(inner) for key, inner in value.items()}
    if isinstance(value, (list, tuple)):
        return [_encoded(inner) for inner in value]
    if type(value) is str:
        value.encode("utf-8")  # half a character cannot be sent
        return value
    if type(value) is bytes:
        import base64

        return {"/bytes": base64.b64encode(value).decode("ascii")}
    if type(value) is float and value - value != 0.0:
        return {"/float": repr(value)}
    if type(value) in (bool, int, float):
        if type(value) is int and not -(1 << 31) <= value < 1 << 31:
            raise OverflowError("int exceeds XML-RPC limits")
        return value
    if value is None:
        raise TypeError("cannot marshal None unless allow_none is enabled")
    if hasattr(value, "__dict__") and not isinstance(value, (type, bool, int, float, str, bytes)):
        return _encoded(dict(value.__dict__))  # an object is sent as its attributes
    raise TypeError("cannot marshal %s objects" % type(value))


def _decoded(value: Any) -> Any:
    if isinstance(value, list):
        return [_decoded(inner) for inner in value]
    if not isinstance(value, dict):
        return value
    if len(value) == 1 and "/float" in value:
        return float(value["/float"])
    if len(value) == 1 and "/bytes" in value:
        import base64

        return base64.b64decode(value["/bytes"])
    return {key: _decoded(inner) for key, inner in value.items()}


_tree = Tree()


def tree() -> Tree:
    """The one of the system."""
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
