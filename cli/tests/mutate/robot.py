"""Gives light when it is asked to."""

import hrdsl

WARM_UP_TIME = 0.5  # seconds


def mend(node):
    node.sleep(1.0)
    node.emit("mended")


def main():
    node = hrdsl.Node("robot")
    while True:
        event = node.wait_for("asked", "broke", timeout=10.0)
        if event is None:
            return
        if event.name == "broke":
            mend(node)
            continue
        node.sleep(WARM_UP_TIME)
        node.emit("lit")


main()
