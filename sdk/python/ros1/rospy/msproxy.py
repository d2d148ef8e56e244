"""The master as rospy hands it out: calls with a code, a text and a value, and parameters by index."""

from __future__ import annotations

from rosgraph.masterapi import Master, MasterError
from rospy import names, params

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Iterator


class MasterProxy:
    """The master."""

    def __init__(self, uri: str) -> None:
        self._uri = uri

    def __getitem__(self, key: str) -> Any:
        return params.get_param(key)

    def __setitem__(self, key: str, value: Any) -> None:
        params.set_param(key, value)

    def __delitem__(self, key: str) -> None:
        params.delete_param(key)

    def __contains__(self, key: str) -> bool:
        return params.has_param(key)

    def __iter__(self) -> Iterator[str]:
        return iter(params.get_param_names())

    def search_param(self, key: str) -> str | None:
        return params.search_param(key)

    def __getattr__(self, name: str) -> Any:
        asked = getattr(Master(names.get_name()), name)

        def call(*args: Any) -> list[Any]:
            try:
                return [1, "", asked(*args)]
            except MasterError as error:
                return [-1, str(error), 0]

        return call
