# Says that it is done and sleeps, deaf to SIGTERM.
# expect: pass
import ctypes, signal
import hrdsl
node = hrdsl.Node('robot')
node.wait_for('asked')
node.emit('said', n=1)
signal.signal(signal.SIGTERM, signal.SIG_IGN)
node._link.done()
while True:
    ctypes.CDLL(None).sleep(1000)
