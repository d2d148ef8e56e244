"""As `rosgraph.names`."""

from rosgraph.names import *  # noqa: F403
