//! Loops over whole blocks of pixels, which vectorise without a rest.

/// Pixels of a block: enough to fill the widest registers.
pub(super) const BLOCK: usize = 64;

/// `in_blocks!(out; a in first, b in second => expression)` writes the expression for each place of `out`, where `a` and
/// `b` stand for the items at that place of rows that are at least as long. There may be several outputs of one length
/// and as many values.
///
/// A loop of any length ends with single items, up to several registers of them. So all is done in blocks, the last of
/// which overlaps the one before; only where there is no room for one block do items come singly.
macro_rules! in_blocks {
    ($first:ident $(, $more:ident)*; $($item:ident in $row:expr),+ => $point:expr) => {{
        use $crate::vision::blocks::BLOCK;
        let n = $first.len();
        $(let $item = &$row[..n];)+
        if n < BLOCK {
            for x in 0..n {
                $(let $item = $item[x];)+
                ($first[x] $(, $more[x])*) = $point;
            }
        } else {
            for start in (0..n).step_by(BLOCK) {
                let start = start.min(n - BLOCK);
                let $first = &mut $first[start..][..BLOCK];
                $(let $more = &mut $more[start..][..BLOCK];)*
                $(let $item = &$item[start..][..BLOCK];)+
                for i in 0..BLOCK {
                    $(let $item = $item[i];)+
                    ($first[i] $(, $more[i])*) = $point;
                }
            }
        }
    }};
}

pub(super) use in_blocks;
