"""What programs ask of the ROS graph."""

from __future__ import annotations

import sys

from rosgraph import names
from rosgraph.masterapi import Master, MasterError, MasterException, MasterFailure
from rosgraph.masterapi import is_online as is_master_online
from rosgraph.rosenv import ROS_HOSTNAME, ROS_IP, ROS_IPV6, ROS_MASTER_URI, ROS_NAMESPACE, get_master_uri

__all__ = [
    "ROS_HOSTNAME", "ROS_IP", "ROS_IPV6", "ROS_MASTER_URI", "ROS_NAMESPACE", "Master", "MasterError", "MasterException",
    "MasterFailure", "get_master_uri", "is_master_online", "myargv", "names",
]  # fmt: skip


def myargv(argv: list[str] | None = None) -> list[str]:
    """The arguments without those that remap."""
    return [arg for arg in (sys.argv if argv is None else argv) if names.REMAP not in arg]
