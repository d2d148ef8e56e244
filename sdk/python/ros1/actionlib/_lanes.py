"""Threads that call the program, one for each kind of news, as subscribers have them."""

from __future__ import annotations

import threading

import rospy
from hrdsl.mailbox import Mailbox

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Callable


class Lane:
    """Calls a function for each thing that is put in, one after the other."""

    def __init__(self, name: str, function: Callable[..., Any]) -> None:
        self._name, self._function = name, function
        self._items: Any = Mailbox()
        threading.Thread(target=self._run, name=name, daemon=True).start()

    def put(self, *args: Any) -> None:
        """Returns at once, so that handlers of arrivals can call it."""
        self._items.put(args)

    def _run(self) -> None:
        while True:
            args = self._items.get()
            try:
                self._function(*args)
            except Exception:
                import traceback

                what = "%s for %s" % (getattr(self._function, "__qualname__", self._function), self._name)
                rospy.logerr("bad callback: %s\n%s" % (what, traceback.format_exc()))
            del args  # what nobody else has ends here, and not with the next item
