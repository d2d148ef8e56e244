# Fails when an object is let go.
# expect: pass
# output: "RuntimeError"
import hrdsl
node = hrdsl.Node('robot')
class Bad:
    def __del__(self):
        raise RuntimeError('gone')
Bad()
node.wait_for('asked')
node.emit('said', n=1)
