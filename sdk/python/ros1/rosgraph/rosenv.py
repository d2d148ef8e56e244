"""What the environment says of the graph."""

from __future__ import annotations

import os
import sys

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

ROS_MASTER_URI = "ROS_MASTER_URI"
ROS_IP = "ROS_IP"
ROS_IPV6 = "ROS_IPV6"
ROS_HOSTNAME = "ROS_HOSTNAME"
ROS_NAMESPACE = "ROS_NAMESPACE"

DEFAULT_MASTER_PORT = 11311
DEFAULT_MASTER_URI = "http://localhost:%d/" % DEFAULT_MASTER_PORT


def get_master_uri(env: Mapping[str, str] | None = None, argv: Sequence[str] | None = None) -> str:
    """Where the master is: as an argument says, or the environment."""
    for arg in sys.argv if argv is None else argv:
        if arg.startswith("__master:="):
            parts = arg.split(":=")
            if len(parts) != 2 or not parts[1]:
                raise ValueError("__master remapping argument '%s' improperly specified" % arg)
            return parts[1]
    return (os.environ if env is None else env).get(ROS_MASTER_URI, DEFAULT_MASTER_URI)
