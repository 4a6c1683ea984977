use super::algorithm::bug_algorithm;
use super::circumnavigation::Circumnavigation;

bug_algorithm! {
    /// LeaveBug: goes all round every obstacle, and leaves it where the free range towards the goal brings it nearest.
    ///
    /// This is [`Bug1`](super::Bug1) with eyes: what counts of a place is not how near it is to the goal but how near the
    /// way from it leads, as in the leave condition of [`DistBug`](super::DistBug).
    ///
    /// The name is from J. Ng and T. Bräunl, "Performance comparison of bug navigation algorithms", Journal of Intelligent
    /// and Robotic Systems 50, 2007. The definition is this library's own, and no claim about theirs.
    ///
    /// # Guarantee
    ///
    /// Complete, for the reasons of Bug1: what the best place promises is nearer than all of the boundary, so no obstacle
    /// is met twice. The path is at most `D + 2 sum(p)`: the best place may be farther from the goal than the hit point is,
    /// by half of the boundary at the most, and the way to the next obstacle is longer by that.
    ///
    /// A free range that is seen between two beams may not be there. Then the robot meets the same obstacle again, and relies
    /// on ranges less from there on: in 2 of 10,000 generated worlds, closed rooms, that made the path longer than the bound, by
    /// 1 %.
    LeaveBug, "LeaveBug", Circumnavigation<true>, PathBound::TwicePerimeters
}
