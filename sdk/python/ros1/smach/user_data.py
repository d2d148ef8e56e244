"""Userdata: what states hand on to each other, and the view that each state has of it."""

from __future__ import annotations

import smach

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Iterable, Mapping

__all__ = ["UserData", "Remapper"]

_READ = (
    "Reading from SMACH userdata key '%s' but the only keys that were declared as input to this state were: %s."
    " This key needs to be declared as input to this state. "
)
_WRITTEN = "Writing to SMACH userdata key '%s' but the only keys that were declared as output from this state were: %s."


class UserData:
    """Values by their keys, as attributes and as items. A key that begins with `_` is an item only."""

    def __init__(self) -> None:
        object.__setattr__(self, "_data", {})

    def update(self, other_userdata: UserData) -> None:
        """Takes all values of another over."""
        self._data.update(other_userdata._data)

    def extract(self, keys: Iterable[str], remapping: Mapping[str, str]) -> UserData:
        """Copies of some values; `remapping` has the keys here by the keys there."""
        import copy

        there = {remapping[key]: key for key in remapping}
        if len(there) != len(remapping):
            smach.logerr("SMACH userdata remapping is not one-to-one: %s" % (remapping,))
        found = UserData()
        for key in keys:
            found[there.get(key, key)] = copy.copy(self[key])
        return found

    def merge(self, ud: UserData, keys: Iterable[str], remapping: Mapping[str, str]) -> None:
        """Takes copies of some values of another over; `remapping` has the keys here by the keys there."""
        import copy

        for key in keys:
            self[remapping.get(key, key)] = copy.copy(ud[key])

    def keys(self) -> list[str]:
        """All keys."""
        return list(self._data)

    def __contains__(self, key: object) -> bool:
        return key in self._data

    def __getitem__(self, key: str) -> Any:
        return self.__getattr__(key)

    def __setitem__(self, key: str, item: Any) -> None:
        self._data[key] = item

    def __getattr__(self, name: str) -> Any:
        if name[0] == "_":
            raise AttributeError(name)
        try:
            return self._data[name]
        except KeyError:
            available = list(self._data)
            smach.logerr("Userdata key '%s' not available. Available keys are: %s" % (name, available))
            # Without the key, as programs that catch it know it.
            raise KeyError() from None

    def __setattr__(self, name: str, value: Any) -> None:
        if name[0] == "_":
            object.__setattr__(self, name, value)
        else:
            self._data[name] = value


def get_const(obj: Any) -> Any:
    """A view of an object that has attributes of its own; any other value as it is."""
    if hasattr(obj, "__dict__"):
        smach.logdebug("Making const '%s'" % (obj,))
        return Const(obj)
    return obj


class Const:
    """What a state sees of an object that it may read and not write.

    What it sets there stays in the view: the object does not change, and neither does anybody complain.
    """

    def __init__(self, obj: Any) -> None:
        smach.logdebug("Making const '%s'" % (obj,))
        self._obj = obj

    def __getattr__(self, name: str) -> Any:
        if name == "_obj":  # of a view that is just being copied
            raise AttributeError(name)
        smach.logdebug("Getting '%s' from const wrapper." % name)
        return get_const(getattr(self._obj, name))

    def __getitem__(self, name: Any) -> Any:
        smach.logdebug("Getting '%s' from const wrapper." % (name,))
        return get_const(self._obj[name])

    def __delattr__(self, name: str) -> None:
        smach.logerr("Attempting to delete '%s' but this member is read-only." % name)
        raise TypeError()


class Remapper:
    """The userdata of a container as one of its states sees it: the declared keys, under the state's names for them."""

    def __init__(
        self,
        ud: Any,
        input_keys: Iterable[str] = [],
        output_keys: Iterable[str] = [],
        remapping: Any = {},
    ) -> None:
        self._ud = ud
        self._input = input_keys
        self._output = output_keys
        self._map = remapping

    def _remap(self, key: str) -> str:
        return self._map[key] if key in self._map else key

    def update(self, other_userdata: UserData) -> None:
        """Takes all values of another over."""
        self._ud.update(other_userdata)

    def keys(self) -> list[str]:
        """Those keys of the container's that the state may read under the same name."""
        return [self._remap(key) for key in self._ud.keys() if key in self._input]

    def __contains__(self, key: Any) -> bool:
        return key in self._input and self._remap(key) in self._ud

    def __getitem__(self, key: str) -> Any:
        if key not in self._input:
            raise smach.InvalidUserCodeError(_READ % (key, self._input))
        value = self._ud[self._remap(key)]
        return value if key in self._output else get_const(value)

    def __setitem__(self, key: str, item: Any) -> None:
        if key in self._output:
            self._ud[self._remap(key)] = item
        else:
            smach.logerr(_WRITTEN % (key, self._output))

    def __getattr__(self, name: str) -> Any:
        if name[0] == "_":
            raise AttributeError(name)
        return self[name]

    def __setattr__(self, name: str, value: Any) -> None:
        if name[0] == "_":
            object.__setattr__(self, name, value)
        else:
            self[name] = value
