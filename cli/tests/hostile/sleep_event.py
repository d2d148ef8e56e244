# Waits for a lock of a thread, where no simulated time passes.
# expect: error "it slept for 1 s of wall time"
import threading
import hrdsl
node = hrdsl.Node('robot')
threading.Event().wait()
