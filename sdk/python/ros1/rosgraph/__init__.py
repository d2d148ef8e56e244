"""What programs ask of the ROS graph."""

from __future__ import annotations

import rosgraph.names
from rosgraph.names import *  # noqa: F403
from rosgraph.master import Master, MasterError, MasterException, MasterFailure

ROS_MASTER_URI = "ROS_MASTER_URI"


def is_master_online(master_uri: str | None = None) -> bool:
    """Always."""
    return True


def get_master_uri(env: object = None, argv: object = None) -> str:
    return "http://localhost:11311"
