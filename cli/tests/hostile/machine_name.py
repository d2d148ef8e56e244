# Renames the machine to what it is called, which it must not.
# expect: pass
# needs: namespaces
import ctypes, os
import hrdsl
node = hrdsl.Node('robot')
name = os.uname().nodename.encode()
if ctypes.CDLL(None).sethostname(name, len(name)) == 0:
    raise SystemExit('it can rename the machine')
node.wait_for('asked')
node.emit('said', n=1)
