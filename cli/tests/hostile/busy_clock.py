# Polls a clock that only it could advance.
# expect: error "within 1 s of processor time"
import time
import hrdsl
node = hrdsl.Node('robot')
start = time.monotonic()
while time.monotonic() < start + 1:
    pass
