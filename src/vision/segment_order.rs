use crate::random::Stream;

/// Order in which pixels vote for the lines of [`HoughSegments`](super::HoughSegments), and votes that a
/// found segment withdraws.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum SegmentDefinition {
    /// Random order. A segment withdraws the votes of its pixels that have voted, as in the paper.
    Voted {
        /// Seed of the order.
        seed: u64,
    },
    /// OpenCV's order, the same for every image. A segment withdraws one vote per pixel, even for pixels that
    /// never voted, so lines that cross it need more votes than the threshold.
    OpenCv,
}

impl Default for SegmentDefinition {
    fn default() -> Self {
        Self::Voted { seed: 1 }
    }
}

/// Draws the pixel that votes next.
#[derive(Debug)]
pub(super) enum Draw {
    Seeded(Stream),
    Carrying(MultiplyWithCarry),
}

impl Draw {
    pub(super) fn new(definition: SegmentDefinition) -> Self {
        match definition {
            SegmentDefinition::Voted { seed } => Self::Seeded(Stream::new(seed)),
            SegmentDefinition::OpenCv => Self::Carrying(MultiplyWithCarry(u64::MAX)),
        }
    }

    /// A number below `end`.
    pub(super) fn below(&mut self, end: usize) -> usize {
        match self {
            Self::Seeded(stream) => stream.below(end),
            Self::Carrying(generator) => generator.next() as usize % end,
        }
    }
}

/// OpenCV's generator (G. Marsaglia's multiply-with-carry): the lower half of the state is the number, the
/// upper half the carry.
#[derive(Debug)]
pub(super) struct MultiplyWithCarry(u64);

impl MultiplyWithCarry {
    /// OpenCV's multiplier.
    const FACTOR: u64 = 4_164_903_690;

    fn next(&mut self) -> u32 {
        let (number, carry) = (self.0 & u64::from(u32::MAX), self.0 >> 32);
        self.0 = number * Self::FACTOR + carry;
        self.0 as u32
    }
}
