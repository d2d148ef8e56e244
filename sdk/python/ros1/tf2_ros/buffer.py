"""`Buffer`: the tree of frames, with waits for what is not known yet."""

from __future__ import annotations

import rospy
import tf2_py
from hrdsl.mailbox import Mailbox
from tf2_ros.buffer_interface import BufferInterface

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Callable

_NONE = rospy.Duration(0.0)


class Buffer(tf2_py.BufferCore, BufferInterface):
    """Where frames were, for the last ten seconds or for a `rospy.Duration`. (The service `tf2_frames`, which `debug` asks
    for in the original, is not there.)"""

    def __init__(self, cache_time: Any = None, debug: bool = True) -> None:
        tf2_py.BufferCore.__init__(self, cache_time)
        BufferInterface.__init__(self)

    def lookup_transform(self, target_frame: str, source_frame: str, time: Any, timeout: Any = _NONE) -> Any:
        """Where `source_frame` was, as seen from `target_frame`; waits until that is known, at most for the timeout."""
        self.can_transform(target_frame, source_frame, time, timeout)
        return self.lookup_transform_core(target_frame, source_frame, time)

    def lookup_transform_full(
        self,
        target_frame: str,
        target_time: Any,
        source_frame: str,
        source_time: Any,
        fixed_frame: str,
        timeout: Any = _NONE,
    ) -> Any:
        """The same between two times, with a frame that did not move between them."""
        self.can_transform_full(target_frame, target_time, source_frame, source_time, fixed_frame, timeout)
        return self.lookup_transform_full_core(target_frame, target_time, source_frame, source_time, fixed_frame)

    def can_transform(
        self, target_frame: str, source_frame: str, time: Any, timeout: Any = _NONE, return_debug_tuple: bool = False
    ) -> Any:
        """Whether that is known, at the latest after the timeout, as 1 or 0; with `return_debug_tuple`, also why not."""
        found = self._wait(lambda: self.can_transform_core(target_frame, source_frame, time), timeout)
        return (int(found[0]), found[1]) if return_debug_tuple else int(found[0])

    def can_transform_full(
        self,
        target_frame: str,
        target_time: Any,
        source_frame: str,
        source_time: Any,
        fixed_frame: str,
        timeout: Any = _NONE,
        return_debug_tuple: bool = False,
    ) -> Any:
        """The same between two times."""

        def ask() -> tuple[bool, str]:
            return self.can_transform_full_core(target_frame, target_time, source_frame, source_time, fixed_frame)

        found = self._wait(ask, timeout)
        return (int(found[0]), found[1]) if return_debug_tuple else int(found[0])

    def _wait(self, ask: Callable[[], tuple[bool, str]], timeout: Any) -> tuple[bool, str]:
        found = ask()
        if found[0] or timeout == _NONE:
            rospy.is_shutdown()  # a poll: programs ask in loops
            return found
        deadline = rospy.Time.now() + timeout
        mailbox = Mailbox()

        def wake() -> None:
            mailbox.put(True)

        self._waiting.append(wake)
        try:
            while not found[0]:
                left = (deadline - rospy.Time.now()).to_nsec()
                if left <= 0:
                    break
                mailbox.get(min(left, 1_000_000_000))
                if rospy.is_shutdown():
                    raise rospy.ROSInterruptException("ROS shutdown request")
                found = ask()
        finally:
            self._waiting.remove(wake)
        return found
