"""Messages whose arrays of numbers are NumPy's."""

from __future__ import annotations

import io

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

        def to_json(message: Any) -> str:
            return str(msg_type._json(_received(msg_type, message)))

        made: Any = type(
            "Numpy_%s" % msg_type._type.replace("/", "__"),
            (msg_type,),
            {
                "__slots__": msg_type.__slots__,
                "_of_json": staticmethod(of_json),
                "_json": staticmethod(to_json),
                "serialize": _serialize,
                "deserialize": _deserialize,
            },
        )
        _made[msg_type] = made
    return _made[msg_type]


def _serialize(self: Any, buff: Any) -> None:
    import numpy

    self.serialize_numpy(buff, numpy)


def _deserialize(self: Any, str: bytes) -> Any:
    import numpy

    return self.deserialize_numpy(str, numpy)


def _received(msg_type: Any, message: Any) -> Any:
    """What subscribers make of the bytes of its arrays, which are sent whatever numbers they are of."""
    from genpy.message import DeserializationError, SerializationError

    file = io.BytesIO()
    message.serialize(file)
    try:
        return msg_type().deserialize(file.getvalue())
    except (DeserializationError, ValueError, IndexError) as error:
        told = "no subscriber could read this %s: an array of NumPy has another dtype or size than its field (%s)"
        raise SerializationError(told % (msg_type._type, error)) from None
