# Freezes and switches off the garbage collector; it answers.
# expect: pass
import gc
import hrdsl
node = hrdsl.Node('robot')
gc.freeze()
gc.disable()
gc.set_threshold(0)
node.wait_for('asked')
node.emit('said', n=1)
