# Writes to a setting of the kernel what is there, which it must not.
# expect: pass
# needs: namespaces
import hrdsl
node = hrdsl.Node('robot')
try:
    text = open('/proc/sys/vm/swappiness').read()
    open('/proc/sys/vm/swappiness', 'w').write(text)
    raise SystemExit('it can change the kernel')
except OSError:
    pass
node.wait_for('asked')
node.emit('said', n=1)
