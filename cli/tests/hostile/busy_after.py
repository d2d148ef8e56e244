# Says that it is done and computes for ever.
# expect: pass
import hrdsl
node = hrdsl.Node('robot')
node.wait_for('asked')
node.emit('said', n=1)
node._link.done()
while True:
    pass
