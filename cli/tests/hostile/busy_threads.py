# Computes for ever in eight threads.
# expect: error "within 1 s of processor time"
import threading
import hrdsl
node = hrdsl.Node('robot')
def spin():
    while True:
        pass
for _ in range(8):
    threading.Thread(target=spin).start()
spin()
