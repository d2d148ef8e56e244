# Has a function to be called at its end that never returns.
# expect: pass
import atexit, select
import hrdsl
node = hrdsl.Node('robot')
atexit.register(lambda: select.select([], [], [], 1000))
node.wait_for('asked')
node.emit('said', n=1)
