# Gives files names with line breaks, of 255 bytes, and of no text; it answers.
# expect: pass
# options: --keep-files
import hrdsl
node = hrdsl.Node('robot')
for name in [b'a\nb', b'x' * 255, b'\xff\xfe', b'\x1b[31m', b'-rf', b' ']:
    open(name, 'w').write('x')
node.wait_for('asked')
node.emit('said', n=1)
