"""Identifiers of goals, as servers and clients make them."""

from __future__ import annotations

import rospy
from actionlib_msgs.msg import GoalID

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_count = 0


class GoalIDGenerator:
    """Makes identifiers that begin with a name, by default the node's."""

    def __init__(self, name: str | None = None) -> None:
        self.set_name(rospy.get_name() if name is None else name)

    def set_name(self, name: str) -> None:
        """What identifiers begin with from now on."""
        self.name = name

    def generate_ID(self) -> Any:
        """A new identifier, with the present time."""
        global _count
        _count += 1
        now = rospy.Time.now()
        return GoalID(stamp=now, id="%s-%d-%d.%d" % (self.name, _count, now.secs, now.nsecs))
