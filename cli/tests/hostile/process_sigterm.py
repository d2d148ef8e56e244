# Sleeps when it is asked to end.
# expect: error "within 1 s of processor time"
import select, signal
import hrdsl
node = hrdsl.Node('robot')
signal.signal(signal.SIGTERM, lambda *_: select.select([], [], [], 1000))
while True:
    pass
