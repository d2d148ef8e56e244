# Writes to its scenario, its results, its home and /tmp; it answers.
# expect: pass
# options: --keep-files
import os
import hrdsl
node = hrdsl.Node('robot')
for path in ['scenario.hri', 'out/results.json', 'tests.hri', os.path.expanduser('~/x'), os.environ['TMPDIR'] + '/y']:
    os.makedirs(os.path.dirname(path) or '.', exist_ok=True)
    open(path, 'w').write('mine')
node.wait_for('asked')
node.emit('said', n=1)
