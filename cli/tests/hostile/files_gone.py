# Works in a folder that is gone; it answers.
# expect: pass
import os
import hrdsl
node = hrdsl.Node('robot')
os.mkdir('gone')
os.chdir('gone')
os.rmdir('../gone')
node.wait_for('asked')
node.emit('said', n=1)
