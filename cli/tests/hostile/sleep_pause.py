# Waits for a signal that never comes.
# expect: error "deadlock: all threads of the program wait"
import signal
import hrdsl
node = hrdsl.Node('robot')
signal.pause()
