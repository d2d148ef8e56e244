# Has a function to be called at its end that never returns.
# expect: pass
import atexit, ctypes
import hrdsl
node = hrdsl.Node('robot')
atexit.register(lambda: ctypes.CDLL(None).sleep(1000))
node.wait_for('asked')
node.emit('said', n=1)
