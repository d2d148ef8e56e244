# Asks for events with names of half a megabyte.
# expect: error "ProtocolError"
import hrdsl
node = hrdsl.Node('robot')
node.emit('x' * 500_000)
