# Sleeps when it is asked to end.
# expect: error "within 1 s of processor time"
import ctypes, signal
import hrdsl
node = hrdsl.Node('robot')
signal.signal(signal.SIGTERM, lambda *_: ctypes.CDLL(None).sleep(1000))
while True:
    pass
