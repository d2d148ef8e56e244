# Waits for a signal that never comes, where no simulated time passes.
# expect: error "it slept for 1 s of wall time"
import signal
import hrdsl
node = hrdsl.Node('robot')
signal.pause()
