//! The priority queue of the grid searches.

/// Marks the end of a chain.
const NONE: u32 = u32::MAX;

/// A queue of nodes by estimated cost, in buckets about half a step wide; last in, first out within a bucket.
///
/// Within a bucket the order is not that of the costs. A search stays exact if it expands a node again that
/// gets cheaper, and continues until no bucket can hold anything cheaper than its result. In exchange push
/// and pop cost next to nothing.
#[derive(Debug, Clone, Default)]
pub(super) struct BucketQueue {
    /// Newest entry of each bucket.
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
    /// Number of low bits of an estimate that a bucket ignores: less than half of a straight step.
    const SHIFT: u32 = 14;

    /// Empties the queue. No later entry may cost less than `base`.
    pub(super) fn start(&mut self, base: u64) {
        self.heads.clear();
        self.entries.clear();
        (self.base, self.current, self.left) = (base, 0, 0);
    }

    /// Adds a node by its `estimate`, with its `cost` so far.
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

    /// A node of the cheapest bucket, with its cost so far; `None` if no bucket can hold an estimate below
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
        // The newest of all entries can be freed.
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
