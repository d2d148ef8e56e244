"""How values of a type are brought into another frame, and converted into other types, under both clients."""

from __future__ import annotations

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Callable


class TypeException(Exception):
    """Nobody has said how that is done with this type."""

    def __init__(self, errstr: str) -> None:
        super().__init__(errstr)
        self.errstr = errstr


class NotImplementedException(Exception):
    """A buffer that cannot look transforms up."""

    def __init__(self) -> None:
        self.errstr = "CanTransform or LookupTransform is not implemented"
        super().__init__(self.errstr)


def Stamped(obj: Any, stamp: Any, frame_id: str) -> Any:
    """The object, with a header."""
    from std_msgs.msg import Header

    obj.header = Header(frame_id=frame_id, stamp=stamp)
    return obj


class _Registry:
    """Functions by their types."""

    def __init__(self) -> None:
        self._functions: dict[Any, Any] = {}

    def add(self, key: Any, function: Any) -> None:
        self._functions[key] = function

    def get(self, key: Any) -> Any:
        try:
            return self._functions[key]
        except KeyError:
            raise TypeException(
                "Type %s is not loaded or supported (for messages of geometry_msgs, import tf2_geometry_msgs)" % (key,)
            ) from None


_transforms, _to_messages, _from_messages, _conversions = (_Registry() for _ in range(4))


class TransformRegistration:
    """How messages of a type are brought into another frame."""

    def print_me(self) -> None:
        """Prints all."""
        print(_transforms._functions)

    def add(self, key: Any, callback: Callable[[Any, Any], Any]) -> None:
        """`callback(message, transform)` does it."""
        _transforms.add(key, callback)

    def get(self, key: Any) -> Any:
        """What does it."""
        return _transforms.get(key)


class ConvertRegistration:
    """How values of a type are converted."""

    def add_from_msg(self, key: Any, callback: Callable[[Any], Any]) -> None:
        """From a message."""
        _from_messages.add(key, callback)

    def add_to_msg(self, key: Any, callback: Callable[[Any], Any]) -> None:
        """Into a message."""
        _to_messages.add(key, callback)

    def add_convert(self, key: Any, callback: Callable[[Any], Any]) -> None:
        """From the first to the second of two types."""
        _conversions.add(key, callback)

    def get_from_msg(self, key: Any) -> Any:
        """What does it."""
        return _from_messages.get(key)

    def get_to_msg(self, key: Any) -> Any:
        """What does it."""
        return _to_messages.get(key)

    def get_convert(self, key: Any) -> Any:
        """What does it."""
        return _conversions.get(key)


def convert(a: Any, b_type: Any) -> Any:
    """The value in another type: directly, or by way of a message."""
    import copy

    if (type(a), b_type) in _conversions._functions:
        return _conversions.get((type(a), b_type))(a)
    if type(a) is b_type:
        return copy.deepcopy(a)
    return _from_messages.get(b_type)(_to_messages.get(type(a))(a))
