# Stops itself.
# expect: error "it slept for 1 s of wall time"
import os, signal
import hrdsl
node = hrdsl.Node('robot')
os.kill(os.getpid(), signal.SIGSTOP)
