# Computes for ever between two requests.
# expect: error "within 1 s of processor time"
import hrdsl
node = hrdsl.Node('robot')
node.now()
while True:
    pass
