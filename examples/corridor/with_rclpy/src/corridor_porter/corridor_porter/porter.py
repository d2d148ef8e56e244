"""The node that takes orders, and goes through the corridor piece by piece."""

import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from rclpy.node import Node
from rclpy.task import Future
from std_msgs.msg import Bool, String

from corridor_interfaces.srv import Look

from .lookout import LATCHED
from .wheels import Wheels


class Porter(Node):
    def __init__(self):
        super().__init__("porter")
        self.pieces = self.declare_parameter("pieces", 1).value
        self.piece = self.declare_parameter("piece", 0.1).value
        self.asks = self.declare_parameter("asks", 1).value
        self.patience = self.declare_parameter("patience", 1.0).value
        self.fright = self.declare_parameter("fright", 1.0).value
        closing_time = self.declare_parameter("closing_time", 10.0).value

        self.wheels = Wheels(self)
        self.cleared = None
        events = self.events = ReentrantCallbackGroup()
        self.speech = self.create_publisher(String, "speech", 10)
        self.lookout = self.create_client(Look, "lookout/look", callback_group=events)
        self.create_subscription(Bool, "lookout/someone", self.on_someone, LATCHED, callback_group=events)
        # In a group of its own an order waits until the one before it is carried out.
        self.create_subscription(Bool, "go", self.on_order, 10, callback_group=MutuallyExclusiveCallbackGroup())
        self.closing = self.create_timer(closing_time, self.close, callback_group=events)
        self.lookout.wait_for_service()

    async def on_order(self, _):
        self.closing.cancel()
        self.say(await self.trip())
        self.closing.reset()

    async def trip(self):
        """Goes through the corridor. What there is to say at its end."""
        asks = pieces = 0
        while True:
            if not await self.is_free():
                if asks == self.asks:
                    return "I cannot get through."
                asks += 1
                self.say("Excuse me, please.")
                self.cleared = Future()
                await self.wait(self.patience, self.cleared)
            elif pieces == self.pieces:
                return "Here I am."
            elif await self.wheels.drive(self.piece):
                pieces += 1
                self.get_logger().debug("piece %d of %d" % (pieces, self.pieces))
            else:
                self.get_logger().warning("somebody came in between")
                await self.wait(self.fright, Future())

    async def is_free(self):
        answer = await self.lookout.call_async(Look.Request())
        return answer.is_free

    async def wait(self, seconds, future):
        """Waits for a future, but no longer than so."""
        timer = self.create_timer(seconds, lambda: finish(future), callback_group=self.events)
        await future
        self.destroy_timer(timer)

    def on_someone(self, message):
        if message.data:
            self.wheels.brake()
        elif self.cleared is not None:
            finish(self.cleared)

    def say(self, text):
        self.get_logger().info(text)
        self.speech.publish(String(data=text))

    def close(self):
        self.get_logger().info("nobody needs me any more")
        rclpy.shutdown()


def finish(future):
    if not future.done():
        future.set_result(None)
