"""Does what programs do when they end."""

import hrdsl

node = hrdsl.Node("stopped")
try:
    while True:
        try:
            node.wait_for("never")
        except Exception:
            print("swallowed")
except hrdsl.Stopped as stopped:
    print("stopped:", stopped)
    raise
finally:
    print("cleaning up")
    node.emit("too_late")
