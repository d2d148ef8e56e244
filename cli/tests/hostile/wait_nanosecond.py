# Lets one nanosecond pass at a time.
# expect: error "of processor time in this test"
import hrdsl
node = hrdsl.Node('robot')
while True:
    node.sleep(1e-9)
