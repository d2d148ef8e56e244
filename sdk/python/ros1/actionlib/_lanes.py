"""Threads that call the program, one for each kind of news, as subscribers have them."""

from __future__ import annotations

import threading

import rospy
from hrdsl import told
from hrdsl.mailbox import Mailbox

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Callable


class Lane:
    """Calls a function for each thing that is put in, one after the other."""

    def __init__(self, name: str, function: Callable[..., Any]) -> None:
        self._name, self._function = name, function
        self._items: Any = Mailbox()
        threading.Thread(target=self._work, name=name, daemon=True).start()

    def put(self, *args: Any) -> None:
        """Returns at once, so that handlers of arrivals can call it."""
        self._items.put(args)

    def _work(self) -> None:
        try:
            self._run()
        except Exception as error:  # that what a callback has published was refused
            rospy.core.failed("callback for %s: %s" % (self._name, told.name_of(self._function)), error)
            raise

    def _run(self) -> None:
        while True:
            args = self._items.get()
            try:
                self._function(*args)
            except Exception as error:
                import traceback

                what = "%s for %s" % (getattr(self._function, "__qualname__", self._function), self._name)
                rospy.logerr("bad callback: %s\n%s" % (what, traceback.format_exc()))
                rospy.core.failed("callback for %s: %s" % (self._name, told.name_of(self._function)), error)
            del args  # what nobody else has ends here, and not with the next item
