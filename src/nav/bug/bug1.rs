use super::algorithm::bug_algorithm;
use super::circumnavigation::Circumnavigation;

bug_algorithm! {
    /// Bug1: follows the whole boundary of every obstacle and leaves it at the point nearest to the goal (V.
    /// J. Lumelsky and A. A. Stepanov, "Path-planning strategies for a point mobile automaton moving amidst
    /// unknown obstacles of arbitrary shape", Algorithmica 2, 1987).
    ///
    /// The robot drives towards the goal until an obstacle blocks it, follows the boundary once round,
    /// returns by the shorter way to the point nearest to the goal, and leaves. If the way from there leads
    /// into the same obstacle, no way exists.
    ///
    /// # Guarantee
    ///
    /// Complete. The path is at most `D + 1.5 sum(p)`, where `D` is the straight distance and `p` the
    /// perimeters of the boundaries met: each is met at most once.
    ///
    /// # Model
    ///
    /// As for [`DistBug`](super::DistBug): the robot is a disc, and boundaries are those of inflated
    /// obstacles. It uses the lidar only as a tactile sensor.
    Bug1, "Bug1", Circumnavigation<false>, PathBound::Perimeters
}
