# Waits for a hundred thousand events at once.
# expect: pass
import hrdsl
node = hrdsl.Node('robot')
try:
    node.wait_for(*['e%d' % n for n in range(50_000)])
except hrdsl.ProtocolError:
    pass
node.wait_for('asked')
node.emit('said', n=1)
