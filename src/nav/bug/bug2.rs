use super::algorithm::bug_algorithm;
use super::first_leave::FirstLeave;
use super::leave_rule::OnMainLine;

bug_algorithm! {
    /// Bug2: leaves an obstacle on the straight line from start to goal (V. J. Lumelsky and A. A. Stepanov,
    /// "Path-planning strategies for a point mobile automaton moving amidst unknown obstacles of arbitrary
    /// shape", Algorithmica 2, 1987).
    ///
    /// The robot drives along that line, the *M-line*, until an obstacle blocks it: the hit point. It follows
    /// the boundary until it crosses the M-line nearer to the goal than the hit point, with the way along it
    /// open: the leave point. Back at the hit point without having left, it reports that no way exists.
    ///
    /// # Guarantee
    ///
    /// Complete. The path is at most `D + sum(n p) / 2`, where `D` is the straight distance, and `p` the
    /// perimeter of a boundary that the M-line crosses `n` times. Efficient among convex obstacles, where it
    /// beats [`Bug1`](super::Bug1); in a maze it may follow parts of a boundary repeatedly.
    ///
    /// # Model
    ///
    /// As for [`DistBug`](super::DistBug): the robot is a disc, and boundaries are those of inflated
    /// obstacles. It uses the lidar only as a tactile sensor. The robot rolls a few centimetres past the
    /// M-line when it leaves, so the line is drawn anew from each hit point to the goal; crossings are
    /// counted on the line of the hit point.
    Bug2, "Bug2", FirstLeave<OnMainLine<false>>, PathBound::Crossings
}
