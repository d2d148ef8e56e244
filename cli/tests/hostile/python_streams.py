# Has no output any more; it answers.
# expect: pass
import sys
import hrdsl
node = hrdsl.Node('robot')
sys.stdout = sys.stderr = sys.__stdout__ = sys.__stderr__ = None
print('lost')
node.wait_for('asked')
node.emit('said', n=1)
