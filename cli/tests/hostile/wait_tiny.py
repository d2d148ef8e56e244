# Waits for less than a nanosecond, for ever: as for nothing at all, so that a thousand such waits let a millisecond pass.
# expect: error "the program used more than 5 s of processor time"
import hrdsl
node = hrdsl.Node('robot')
while True:
    node.sleep(1e-10)
