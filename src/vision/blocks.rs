//! Loops over whole blocks of pixels, which vectorise without a remainder.

/// Items per block: as many as fill the widest register.
#[inline(always)]
pub(super) const fn block_of<T>(_: &[T]) -> usize {
    64 / size_of::<T>()
}

/// `in_blocks!(out; a in first, b in second => expression)` evaluates the expression for each index of `out`;
/// `a` and `b` are the items of the rows at that index. The rows must be at least as long as `out`. Several
/// outputs of equal length, and as many values, are allowed.
///
/// A plain loop ends with up to several registers of single items. Here everything runs in blocks, the last
/// of which overlaps the one before. Single items occur only where not even one block fits.
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
