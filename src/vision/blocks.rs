//! Loops over whole blocks of pixels, which vectorise without a rest.

/// Items of a block: as many as fill the widest register.
#[inline(always)]
pub(super) const fn block_of<T>(_: &[T]) -> usize {
    64 / size_of::<T>()
}

/// `in_blocks!(out; a in first, b in second => expression)` writes the expression for each place of `out`, where `a` and
/// `b` stand for the items at that place of rows that are at least as long. There may be several outputs of one length
/// and as many values.
///
/// A loop of any length ends with single items, up to several registers of them. So all is done in blocks, the last of
/// which overlaps the one before; only where there is no room for one block do items come singly.
macro_rules! in_blocks {
    ($first:ident $(, $more:ident)*; $($item:ident in $row:expr),+ => $point:expr) => {{
        let block = $crate::vision::blocks::block_of($first);
        let n = $first.len();
        $(let $item = &$row[..n];)+
        if n < block {
            for x in 0..n {
                $(let $item = $item[x];)+
                ($first[x] $(, $more[x])*) = $point;
            }
        } else {
            for start in (0..n).step_by(block) {
                let start = start.min(n - block);
                let $first = &mut $first[start..][..block];
                $(let $more = &mut $more[start..][..block];)*
                $(let $item = &$item[start..][..block];)+
                for i in 0..block {
                    $(let $item = $item[i];)+
                    ($first[i] $(, $more[i])*) = $point;
                }
            }
        }
    }};
}

pub(super) use in_blocks;
