# Greets for ever.
# expect: error "requests without letting simulated time pass"
import hrdsl
while True:
    hrdsl.Node('robot')
