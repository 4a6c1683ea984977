use super::Examples;
use crate::random::Stream;
use crate::vision::signs::SignPatches;

/// Which sign is shown is drawn at random, so that rare classes are shown oftener.
impl Examples for SignPatches {
    fn count(&self) -> usize {
        self.len()
    }

    fn write(&self, _: usize, random: &mut Stream, input: &mut [f32]) -> f32 {
        self.vary(random, input) as f32
    }
}
