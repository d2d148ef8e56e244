# Writes to /etc, /usr, /var and the root folder; it answers.
# expect: pass
# needs: namespaces
import os
import hrdsl
node = hrdsl.Node('robot')
for folder in ['/etc', '/usr', '/var', '/', '/tmp', '/var/tmp']:
    try:
        open(folder + '/hrdsl-soak', 'w').write('mine')
    except OSError:
        pass
node.wait_for('asked')
node.emit('said', n=1)
