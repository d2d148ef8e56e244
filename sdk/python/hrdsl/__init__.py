"""What robot code imports to be tested in lock-step with simulated time.

    import hrdsl

    node = hrdsl.Node("robot")
    request = node.wait_for("leg_request", timeout=3.0)
    if request is not None:
        node.arm("robot.arm").move_to((0.3, -0.3, 0.55))
        node.gripper("robot.grip").close()
        node.emit("handover_offered")

A call that waits (`sleep`, `wait_for`, an arm's motion) is one message to the harness, which lets simulated time
pass and answers when the wait is over; between calls no simulated time passes. A motion can be begun, too, and waited for
beside events:

    drive = node.device("robot.base").begin("drive", speed=0.3)
    if node.wait_for("child_near", drive) is not drive:
        node.device("robot.base").command("brake")
"""

from hrdsl.errors import ProtocolError, Stopped
from hrdsl.logger import Logger
from hrdsl.node import Arm, Device, Event, Gripper, Motion, Node
from hrdsl.states import StateMachine

__all__ = ["Arm", "Device", "Event", "Gripper", "Logger", "Motion", "Node", "ProtocolError", "StateMachine", "Stopped"]
