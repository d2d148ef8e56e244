# A thread wants to end; it answers.
# expect: pass
import sys, threading
import hrdsl
node = hrdsl.Node('robot')
thread = threading.Thread(target=sys.exit, args=[3])
thread.start()
thread.join()
node.wait_for('asked')
node.emit('said', n=1)
