# Waits for an event that nobody sets: all its threads wait, which is told.
# expect: error "exit code 1"
# output: "hrdsl: deadlock"
import threading
import hrdsl
node = hrdsl.Node('robot')
threading.Event().wait()
