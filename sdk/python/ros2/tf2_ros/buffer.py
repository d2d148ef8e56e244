"""`Buffer`: the tree of frames, with waits for what is not known yet."""

from __future__ import annotations

import time as _time

from rclpy import _world
from rclpy.duration import Duration
from rclpy.task import Future
from tf2_py import BufferCore
from tf2_ros.buffer_interface import BufferInterface

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Callable

_NONE = Duration()

#: Seconds from one look to the next of who waits, as in the original.
_PERIOD = 0.02


class Buffer(BufferCore, BufferInterface):
    """Where frames were, for the last ten seconds or for a `Duration`; with a node, it serves `tf2_frames`.

    Who waits here with a timeout keeps its thread, as on a robot: the transform must be heard by another one."""

    def __init__(self, cache_time: Duration | None = None, node: Any = None) -> None:
        BufferCore.__init__(self, cache_time)
        BufferInterface.__init__(self)
        if node is not None:
            from tf2_msgs.srv import FrameGraph

            self.srv = node.create_service(FrameGraph, "tf2_frames", self._tell)

    def _tell(self, request: Any, response: Any) -> Any:
        response.frame_yaml = self.all_frames_as_yaml()
        return response

    def lookup_transform(self, target_frame: str, source_frame: str, time: Any, timeout: Duration = _NONE) -> Any:
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
        timeout: Duration = _NONE,
    ) -> Any:
        """The same between two times, with a frame that did not move between them."""
        self.can_transform_full(target_frame, target_time, source_frame, source_time, fixed_frame, timeout)
        return self.lookup_transform_full_core(target_frame, target_time, source_frame, source_time, fixed_frame)

    async def lookup_transform_async(self, target_frame: str, source_frame: str, time: Any) -> Any:
        """The same for who awaits it."""
        await self.wait_for_transform_async(target_frame, source_frame, time)
        return self.lookup_transform_core(target_frame, source_frame, time)

    async def lookup_transform_full_async(
        self, target_frame: str, target_time: Any, source_frame: str, source_time: Any, fixed_frame: str
    ) -> Any:
        """The same between two times."""
        await self.wait_for_transform_full_async(target_frame, target_time, source_frame, source_time, fixed_frame)
        return self.lookup_transform_full_core(target_frame, target_time, source_frame, source_time, fixed_frame)

    def can_transform(
        self, target_frame: str, source_frame: str, time: Any, timeout: Duration = _NONE, return_debug_tuple: bool = False
    ) -> Any:
        """Whether that is known, at the latest after the timeout; with `return_debug_tuple`, also why not."""
        found = _waited(lambda: self.can_transform_core(target_frame, source_frame, time), timeout)
        return found if return_debug_tuple else found[0]

    def can_transform_full(
        self,
        target_frame: str,
        target_time: Any,
        source_frame: str,
        source_time: Any,
        fixed_frame: str,
        timeout: Duration = _NONE,
        return_debug_tuple: bool = False,
    ) -> Any:
        """The same between two times."""

        def ask() -> tuple[bool, str]:
            return self.can_transform_full_core(target_frame, target_time, source_frame, source_time, fixed_frame)

        found = _waited(ask, timeout)
        return found if return_debug_tuple else found[0]

    def wait_for_transform_async(self, target_frame: str, source_frame: str, time: Any) -> Future:
        """A future that has the transform once it is known."""
        return self._future(
            lambda: self.can_transform_core(target_frame, source_frame, time),
            lambda: self.lookup_transform_core(target_frame, source_frame, time),
        )

    def wait_for_transform_full_async(
        self, target_frame: str, target_time: Any, source_frame: str, source_time: Any, fixed_frame: str
    ) -> Future:
        """The same between two times."""
        given = target_frame, target_time, source_frame, source_time, fixed_frame
        return self._future(
            lambda: self.can_transform_full_core(*given), lambda: self.lookup_transform_full_core(*given)
        )

    def _future(self, ask: Callable[[], tuple[bool, str]], look_up: Callable[[], Any]) -> Future:
        made = Future()
        if ask()[0]:
            made.set_result(look_up())
            return made

        def look() -> None:
            try:
                if not made.done() and ask()[0]:
                    made.set_result(look_up())
            except BaseException as error:
                made.set_exception(error)

        def forget(_: Future) -> None:
            self._waiting = [call for call in self._waiting if call is not look]

        self._waiting.append(look)
        made.add_done_callback(forget)
        return made


def _waited(ask: Callable[[], tuple[bool, str]], timeout: Duration) -> tuple[bool, str]:
    found = ask()
    if timeout == _NONE:
        _world.looked("transform")  # programs ask in loops
        return found
    end = _world.now() + timeout.nanoseconds
    while not found[0] and _world.now() < end:
        _time.sleep(_PERIOD)
        found = ask()
    return found
