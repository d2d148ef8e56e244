# Is suspended by a child that shares its memory and sleeps.
# expect: error "of wall time"
# options: --wall-limit 8s
import ctypes
import hrdsl
node = hrdsl.Node('robot')
libc = ctypes.CDLL(None)
if libc.vfork() == 0:
    while True:
        libc.sleep(1000)
