# Closes the descriptors of the protocol and sleeps.
# expect: error "it slept for 1 s of wall time"
import ctypes, os
import hrdsl
node = hrdsl.Node('robot')
os.closerange(3, 50)
ctypes.CDLL(None).sleep(1000)
