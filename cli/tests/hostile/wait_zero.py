# Waits for no time, for ever: a thousand such waits let a millisecond pass, so that it comes to its other limits.
# expect: error "the program used more than 5 s of processor time"
import time
import hrdsl
node = hrdsl.Node('robot')
while True:
    time.sleep(0)
