# Ends while threads go on for ever.
# expect: any
import threading, select
import hrdsl
node = hrdsl.Node('robot')
for _ in range(20):
    threading.Thread(target=select.select, args=([], [], [], 1000)).start()
node.wait_for('asked')
node.emit('said', n=1)
