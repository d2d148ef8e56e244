# Empties its mailbox for ever.
# expect: error "requests without letting simulated time pass"
import hrdsl
node = hrdsl.Node('robot')
while True:
    node.drop()
