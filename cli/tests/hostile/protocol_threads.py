# Asks from twenty threads at once; it answers.
# expect: pass
import threading
import hrdsl
node = hrdsl.Node('robot')
def ask():
    for _ in range(100):
        node.now()
threads = [threading.Thread(target=ask) for _ in range(20)]
for thread in threads:
    thread.start()
for thread in threads:
    thread.join()
node.wait_for('asked')
node.emit('said', n=1)
