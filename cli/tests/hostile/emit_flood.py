# Answers for ever at one instant.
# expect: error "events at one instant"
import hrdsl
node = hrdsl.Node('robot')
while True:
    node.emit('said', n=1)
