use super::algorithm::bug_algorithm;
use super::circumnavigation::Circumnavigation;

bug_algorithm! {
    /// LeaveBug: follows the whole boundary of every obstacle, and leaves it where the free range leads
    /// nearest to the goal.
    ///
    /// This is [`Bug1`](super::Bug1) with range sensing: a point is rated by how near the way from it leads
    /// to the goal, as in the leave condition of [`DistBug`](super::DistBug).
    ///
    /// The name is from J. Ng and T. Bräunl, "Performance comparison of bug navigation algorithms", Journal
    /// of Intelligent and Robotic Systems 50, 2007. The definition is this library's own and makes no claim
    /// about theirs.
    ///
    /// # Guarantee
    ///
    /// Complete, for the same reason as Bug1: the predicted distance of the best point is smaller than that
    /// of all of the boundary, so no obstacle is met twice. The path is at most `D + 2 sum(p)`: the best
    /// point may be farther from the goal than the hit point by at most half of the boundary, which lengthens
    /// the way to the next obstacle by as much.
    ///
    /// A free range between two beams may be an illusion. Then the robot meets the same obstacle again and
    /// trusts ranges less from there on. In 2 of 10,000 generated worlds, closed rooms, this made the path 1
    /// % longer than the bound.
    LeaveBug, "LeaveBug", Circumnavigation<true>, PathBound::TwicePerimeters
}
