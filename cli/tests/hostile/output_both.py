# Floods both, from two threads.
# expect: error "bytes of output"
import os, threading
import hrdsl
node = hrdsl.Node('robot')
def flood(fd):
    while True:
        os.write(fd, b'z' * 70)
threading.Thread(target=flood, args=[1]).start()
flood(2)
