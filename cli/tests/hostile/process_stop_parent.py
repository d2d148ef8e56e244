# Stops its parent, and sleeps.
# expect: error "it slept for 1 s of wall time"
# options: --wall-limit 8s
import ctypes, os, signal
import hrdsl
node = hrdsl.Node('robot')
os.kill(os.getppid(), signal.SIGSTOP)
ctypes.CDLL(None).sleep(1000)
