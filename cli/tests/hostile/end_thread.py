# A thread fails; it answers.
# expect: pass
# output: "ZeroDivisionError"
import threading
import hrdsl
node = hrdsl.Node('robot')
thread = threading.Thread(target=lambda: 1 / 0)
thread.start()
thread.join()
node.wait_for('asked')
node.emit('said', n=1)
