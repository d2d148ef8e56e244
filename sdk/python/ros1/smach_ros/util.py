"""What happens to machines when the node is shut down."""

from __future__ import annotations

import rospy

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

__all__ = ["set_preempt_handler"]


def set_preempt_handler(sc: Any) -> None:
    """Lets a container end by preemption when the node is shut down, which waits for it."""

    def handler() -> None:
        sc.request_preempt()
        while sc.is_running():
            rospy.loginfo("Received shutdown request... sent preempt... waiting for state machine to terminate.")
            rospy.sleep(1.0)

    rospy.core.add_client_shutdown_hook(handler)
