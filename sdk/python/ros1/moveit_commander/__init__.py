"""Plans and motions of a robot's groups of joints, with the interface of MoveIt's moveit_commander.

The groups are those of the scenario's binding. A plan goes from posture to posture along a way that touches nothing of the
scenario's world, at the times at which the arm would go them by itself at that speed.
"""

from __future__ import annotations

from moveit_commander.exception import MoveItCommanderException
from moveit_commander.roscpp_initializer import roscpp_initialize, roscpp_shutdown
from moveit_commander.planning_scene_interface import PlanningSceneInterface
from moveit_commander.move_group import MoveGroupCommander
from moveit_commander.robot import RobotCommander

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

__all__ = [
    "MoveGroupCommander",
    "MoveItCommanderException",
    "PlanningSceneInterface",
    "RobotCommander",
    "roscpp_initialize",
    "roscpp_shutdown",
]


class MoveGroupCommandInterpreter:
    """Refused."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        raise NotImplementedError(
            "the interpreter of moveit_commander's own commands is not there in hrdsl: call MoveGroupCommander instead"
        )
