# Removes the functions that trace it; it answers.
# expect: pass
import sys, threading
import hrdsl
node = hrdsl.Node('robot')
sys.settrace(None)
sys.setprofile(None)
threading.settrace(None)
node.wait_for('asked')
node.emit('said', n=1)
