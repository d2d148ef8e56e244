"""Messages whose arrays of numbers are NumPy's."""

from __future__ import annotations

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_made: dict[Any, Any] = {}


def numpy_msg(msg_type: Any) -> Any:
    """The class of such messages; always the same for a class of messages."""
    if msg_type not in _made:
        import numpy
        from genpy import wire

        def of_json(value: Any) -> Any:
            plain = msg_type._of_json(value)
            message = made.__new__(made)
            for name in msg_type.__slots__:
                setattr(message, name, getattr(plain, name))
            return wire.with_numpy(message, numpy)

        made: Any = type(
            "Numpy_%s" % msg_type._type.replace("/", "__"),
            (msg_type,),
            {"__slots__": msg_type.__slots__, "_of_json": staticmethod(of_json), "deserialize": _deserialize},
        )
        _made[msg_type] = made
    return _made[msg_type]


def _deserialize(self: Any, str: bytes) -> Any:
    import numpy

    from genpy import wire

    return wire.with_numpy(wire.read(self, str), numpy)
