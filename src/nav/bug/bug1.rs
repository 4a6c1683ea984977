use super::algorithm::bug_algorithm;
use super::circumnavigation::Circumnavigation;

bug_algorithm! {
    /// Bug1: goes all round every obstacle, and leaves it at its place nearest to the goal (V. J. Lumelsky and
    /// A. A. Stepanov, "Path-planning strategies for a point mobile automaton moving amidst unknown obstacles of arbitrary
    /// shape", Algorithmica 2, 1987).
    ///
    /// The robot drives at the goal until something is in the way, follows the boundary once round, returns to its place
    /// nearest to the goal the shorter way, and leaves. If the way from there leads into the same obstacle, there is none.
    ///
    /// # Guarantee
    ///
    /// Complete. The path is at most `D + 1.5 sum(p)`, where `D` is the straight distance and `p` the perimeters of the
    /// boundaries that are met: each is met once at the most.
    ///
    /// # Model
    ///
    /// As for [`DistBug`](super::DistBug): the robot is a disc, and boundaries are those of obstacles grown by it. Of the
    /// lidar it uses no more than a robot that feels its surroundings would.
    Bug1, "Bug1", Circumnavigation<false>, PathBound::Perimeters
}
