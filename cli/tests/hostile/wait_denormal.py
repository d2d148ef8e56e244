# Waits for the smallest number above nought, then answers.
# expect: pass
import hrdsl
node = hrdsl.Node('robot')
node.sleep(5e-324)
node.wait_for('asked')
node.emit('said', n=1)
