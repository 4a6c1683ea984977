"""Keys, by a script: KEY2@1s,KEY1@2s,KEY4@4s,TOUCH:12:34@5s,IRTV_OK@6s."""

from eye import *

assert KEYRead() == NOKEY
assert KEYGet() == KEY2
assert KEYWait(KEY1) == KEY1
assert KEYWait(ANYKEY) == KEY4
assert KEYGetXY() == [12, 34] and KEYReadXY() == [0, 0]
assert IRTVGet() == IRTV_OK and IRTVRead() == 0
assert 6000 <= OSGetCount() < 6100
