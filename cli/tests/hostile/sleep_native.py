# Waits in a library in C, where no simulated time passes.
# expect: error "it slept for 1 s of wall time"
import ctypes
import hrdsl
node = hrdsl.Node('robot')
ctypes.CDLL(None).sleep(1000)
