# Changes its umask, niceness, signal masks and personality; it answers.
# expect: pass
# options: --keep-files
import ctypes, os, signal
import hrdsl
node = hrdsl.Node('robot')
os.umask(0o777)
os.nice(19)
signal.pthread_sigmask(signal.SIG_BLOCK, range(1, 65))
ctypes.CDLL(None).personality(0)
open('x', 'w').write('x')
node.wait_for('asked')
node.emit('said', n=1)
