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

    reach = node.arm("robot.arm").begin("move_to", to=[0.3, -0.3, 0.55])
    if node.wait_for("child_near", reach) is not reach:
        node.arm("robot.arm").stop()

What a base is told holds from then on, while the program looks:

    node.base("robot.wheels").drive(forward=0.3)
    while min(node.laser("robot.eye").ranges()) > 0.5:
        node.sleep(0.05)
    node.base("robot.wheels").stop()
"""

from hrdsl.errors import ProtocolError, Stopped
from hrdsl.logger import Logger
from hrdsl.node import Arm, Base, Device, Event, Gripper, Laser, Motion, Node
from hrdsl.states import StateMachine

__all__ = ["Arm", "Base", "Device", "Event", "Gripper", "Laser", "Logger", "Motion", "Node", "ProtocolError", "StateMachine", "Stopped"]
