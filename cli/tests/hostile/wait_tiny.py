# Waits for less than a nanosecond, for ever.
# expect: error "requests without letting simulated time pass"
import hrdsl
node = hrdsl.Node('robot')
while True:
    node.sleep(1e-10)
