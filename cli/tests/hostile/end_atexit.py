# Fails at its end.
# expect: any
import atexit
import hrdsl
node = hrdsl.Node('robot')
atexit.register(lambda: 1 / 0)
node.wait_for('asked')
node.emit('said', n=1)
