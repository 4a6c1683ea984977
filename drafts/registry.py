import re
names=["a_to_b","ackermann","camera","color_tracking","coverage","distbug","edges","lidar_scan","localise","motion","omni","random_drive","wall_following"]
p='examples/common/programs.rs'
s=open(p).read()
s=re.sub(r'use crate::\{[^}]*\};','use crate::{%s};'%', '.join(names),s)
a=s.index("pub(crate) const PROGRAMS"); b=s.index("/// A program by its name.")
s=s[:a]+'''/// A table of programs from the names of their modules.
macro_rules! programs {
    ($($name:ident),* $(,)?) => {
        /// All programs, in the order of their names.
        pub(crate) const PROGRAMS: &[Program] = &[$(Program {
            name: stringify!($name),
            run: |words, out, err| run(stringify!($name), words, out, err, $name::work),
        }),*];
    };
}

programs!(%s);

'''%', '.join(names)+s[b:]
open(p,'w').write(s)
mods=sorted(names+["driving","replay","room"])
def decl(prefix):
    out=[]
    for m in sorted(mods+["common","programs"]):
        if m=="common":
            out.append(('#[path = "%scommon/mod.rs"]\n'%prefix if prefix else '')+'mod common;\n')
        elif m=="programs":
            out.append('#[path = "%scommon/programs.rs"]\nmod programs;\n'%prefix)
        else:
            out.append('#[path = "%s%s/mod.rs"]\nmod %s;\n'%(prefix,m,m))
    return ''.join(out)
for p,prefix in (('examples/replay.rs',''),('tests/recordings.rs','../examples/')):
    s=open(p).read()
    i=s.index('#[path'); 
    j=s.index('fn main') if prefix=='' else s.index('use std::ffi')
    s=s[:i]+decl(prefix)+'\n'+s[j:]
    open(p,'w').write(s)
p='examples/common/command_line.rs'
s=open(p).read()
a='const NOT_RECORDED: [&str; 6] = ["record", "replay", "picture", "json", "realtime", "robios"];'
assert a in s
s=s.replace(a,'const NOT_RECORDED: [&str; 8] =\n    ["record", "replay", "picture", "output", "lcd", "json", "realtime", "robios"];')
open(p,'w').write(s)
