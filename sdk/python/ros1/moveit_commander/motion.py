"""Motions of devices: begun, waited for, and ended before their time."""

from __future__ import annotations

from hrdsl.errors import ProtocolError
from hrdsl.exchange import the_exchange
from hrdsl.mailbox import Mailbox
from moveit_commander.exception import MoveItCommanderException

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from moveit_commander.model import Group

#: How many motions of a device have been begun by this program and have not ended.
_running: dict[str, int] = {}


def follow(group: Group, postures: list[list[float]], times: list[float]) -> Any:
    """Begins to move through these postures at these times (seconds from now). At the end, the mailbox that is returned has
    a tuple of why it has failed, or None."""
    ended: Any = Mailbox()
    device = group.device

    def hear(error: str | None) -> None:
        _running[device] -= 1
        ended.put((error,))

    _running[device] = _running.get(device, 0) + 1
    try:
        the_exchange().act(device, "follow", {"positions": _flat(postures), "times": times}, hear)
    except ProtocolError as error:
        _running[device] -= 1
        told = "device %s of group %s follows no trajectories: %s" % (device, group.name, error)
        raise MoveItCommanderException(told) from None
    return ended


def _flat(postures: list[list[float]]) -> list[float]:
    """Posture after posture, as the command takes them."""
    return [angle for posture in postures for angle in posture]


def stop(group: Group) -> None:
    """Ends the motion of the group's device; nothing, if it does not move."""
    if not _running.get(group.device):
        return
    exchange = the_exchange()
    try:
        exchange.act(group.device, "stop", {}, _ignore)
    except ProtocolError:  # a device without that command stays where it is told to
        exchange.act(group.device, "follow", {"positions": group.positions(), "times": [0.0]}, _ignore)


def _ignore(error: str | None) -> None:
    """Who stops a motion does not wait for the end of that."""
