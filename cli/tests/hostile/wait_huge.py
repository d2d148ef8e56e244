# Waits for longer than time lasts.
# expect: any
import hrdsl
node = hrdsl.Node('robot')
node.sleep(1e300)
node.wait_for('asked')
node.emit('said', n=1)
