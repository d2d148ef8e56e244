"""Runs both nodes in one process: the lookout answers while the porter waits for it."""

import rclpy
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor

from .lookout import Lookout
from .porter import Porter


def main(args=None):
    rclpy.init(args=args)
    nodes = [Lookout(), Porter()]
    executor = MultiThreadedExecutor(num_threads=4)
    for node in nodes:
        executor.add_node(node)
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        for node in nodes:
            node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
