"""What is published, from what `publish` is given."""

from __future__ import annotations

import genpy
from rospy.exceptions import ROSException

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


class AnyMsg(genpy.Message):
    """A message of whatever type a topic has, as bytes in `_buff`."""

    __slots__ = ["_buff"]  # type: ignore[assignment]
    _md5sum = "*"
    _type = "*"

    def __init__(self, *args: Any) -> None:
        if args:
            raise ROSException("AnyMsg does not accept arguments")
        self._buff: bytes | None = None

    def serialize(self, buff: Any) -> None:
        if self._buff is None:
            raise ROSException("AnyMsg is not initialized")
        buff.write(self._buff)

    def deserialize(self, str: bytes) -> AnyMsg:
        self._buff = str
        return self


def args_kwds_to_message(data_class: Any, args: tuple[Any, ...], kwds: dict[str, Any]) -> Any:
    """The message that is given, or one of this class made of the values that are."""
    if args and kwds:
        raise TypeError("publish() can be called with arguments or keywords, but not both.")
    if kwds or len(args) != 1:
        return data_class(*args, **kwds)
    given = args[0]
    if getattr(given, "_md5sum", None) == data_class._md5sum or isinstance(given, AnyMsg):
        return given
    if isinstance(given, genpy.Message):
        if not data_class._slot_types:
            raise TypeError("expected [] but got [%s]" % given._type)
        if given._type != data_class._slot_types[0]:
            raise TypeError("expected [%s] but got [%s]" % (data_class._slot_types[0], given._type))
    return data_class(given)
