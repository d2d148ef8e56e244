# Waits for no time, for ever.
# expect: error "requests without letting simulated time pass"
import time
import hrdsl
node = hrdsl.Node('robot')
while True:
    time.sleep(0)
