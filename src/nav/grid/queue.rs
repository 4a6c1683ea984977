//! The queue of the searches on grids.

/// Marks the end of a chain.
const NONE: u32 = u32::MAX;

/// A queue of nodes by estimated cost: buckets about half a step wide, the last node in being the first out.
///
/// Within a bucket the order is not that of the costs. A search stays exact if it takes up a node again that gets
/// cheaper, and goes on until no bucket is left that could hold anything cheaper than what it has found. In exchange
/// both ends of the queue cost next to nothing.
#[derive(Debug, Clone, Default)]
pub(super) struct BucketQueue {
    /// The newest entry of each bucket.
    heads: Vec<u32>,
    entries: Vec<Entry>,
    base: u64,
    current: usize,
    left: usize,
}

#[derive(Debug, Clone, Copy)]
struct Entry {
    node: u32,
    next: u32,
    cost: u64,
}

impl BucketQueue {
    /// Bits of an estimate that a bucket does not tell apart: less than half of a straight step.
    const SHIFT: u32 = 14;

    /// Empties the queue. From now on nothing will come that costs less than `base`.
    pub(super) fn start(&mut self, base: u64) {
        self.heads.clear();
        self.entries.clear();
        (self.base, self.current, self.left) = (base, 0, 0);
    }

    /// Puts a node in by its `estimate`, beside which its `cost` so far is kept.
    #[inline]
    pub(super) fn push(&mut self, estimate: u64, node: u32, cost: u64) {
        let bucket = (estimate.saturating_sub(self.base) >> Self::SHIFT) as usize;
        if bucket >= self.heads.len() {
            self.heads.resize(bucket + 1, NONE);
        }
        let head = &mut self.heads[bucket];
        self.entries.push(Entry { node, next: *head, cost });
        *head = self.entries.len() as u32 - 1;
        self.current = self.current.min(bucket);
        self.left += 1;
    }

    /// A node of the cheapest bucket, with its cost so far; `None` if no bucket is left that could hold an estimate below
    /// `limit`.
    #[inline]
    pub(super) fn pop_below(&mut self, limit: u64) -> Option<(u32, u64)> {
        if self.left == 0 {
            return None;
        }
        while self.heads[self.current] == NONE {
            self.current += 1;
        }
        if self.base + ((self.current as u64) << Self::SHIFT) >= limit {
            return None;
        }
        let index = self.heads[self.current];
        let entry = self.entries[index as usize];
        self.heads[self.current] = entry.next;
        self.left -= 1;
        // The newest of all entries can go for good.
        if index as usize + 1 == self.entries.len() {
            self.entries.pop();
        }
        Some((entry.node, entry.cost))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(crate::testing::cases(256))]
        #[test]
        fn nodes_leave_by_bucket(costs in proptest::collection::vec(0..1u64 << 20, 0..200)) {
            let mut queue = BucketQueue::default();
            queue.start(0);
            for (node, &cost) in costs.iter().enumerate() {
                queue.push(cost, node as u32, cost);
            }
            let out: Vec<_> = std::iter::from_fn(|| queue.pop_below(u64::MAX)).collect();
            prop_assert_eq!(out.len(), costs.len());
            prop_assert!(out.iter().all(|&(node, cost)| costs[node as usize] == cost));
            prop_assert!(out.windows(2).all(|pair| pair[0].1 >> BucketQueue::SHIFT <= pair[1].1 >> BucketQueue::SHIFT));
            // What is below a limit comes out, and little else does.
            queue.start(0);
            for &cost in &costs {
                queue.push(cost, 0, cost);
            }
            let (limit, bucket) = (1 << 19, 1 << BucketQueue::SHIFT);
            let out: Vec<_> = std::iter::from_fn(|| queue.pop_below(limit)).collect();
            prop_assert!(out.iter().all(|&(_, cost)| cost < limit + bucket));
            prop_assert!(out.len() >= costs.iter().filter(|&&cost| cost < limit).count());
        }
    }
}
