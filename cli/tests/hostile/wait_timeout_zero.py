# Looks for an event without waiting, for ever.
# expect: error "requests without letting simulated time pass"
import hrdsl
node = hrdsl.Node('robot')
while True:
    node.wait_for('asked', timeout=0)
