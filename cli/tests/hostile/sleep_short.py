# Waits for many short sleeps inside C code, where no simulated time passes.
# expect: error "it slept for 1 s of wall time"
import ctypes
import hrdsl
node = hrdsl.Node('robot')
while True:
    ctypes.CDLL(None).usleep(50000)
