# Answers once in every nanosecond.
# expect: error " time"
import hrdsl
node = hrdsl.Node('robot')
while True:
    node.emit('said', n=1)
    node.sleep(1e-9)
