# Takes the names by which cores are claimed.
# expect: pass
# needs: namespaces
import socket
import hrdsl
node = hrdsl.Node('robot')
kept = []
for core in range(64):
    for share in range(64):
        kept.append(socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM))
        try:
            kept[-1].bind('\0hrdsl-core-%d-%d' % (core, share))
        except OSError:
            kept.pop()
        if len(kept) > 900:
            break
node.wait_for('asked')
node.emit('said', n=1)
