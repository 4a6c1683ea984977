use super::algorithm::bug_algorithm;
use super::first_leave::FirstLeave;
use super::leave_rule::OnMainLine;

bug_algorithm! {
    /// Bug2: leaves an obstacle on the straight line from start to goal (V. J. Lumelsky and A. A. Stepanov, "Path-planning
    /// strategies for a point mobile automaton moving amidst unknown obstacles of arbitrary shape", Algorithmica 2, 1987).
    ///
    /// The robot drives along that line, the *M-line*, until something is in the way: the hit point. It follows the
    /// boundary until it meets the M-line again, nearer to the goal than the hit point, with the way along it open: the
    /// leave point. Back at the hit point without having left, it knows that there is no way.
    ///
    /// # Guarantee
    ///
    /// Complete. The path is at most `D + sum(n p) / 2`, where `D` is the straight distance, and `p` the perimeter of a
    /// boundary that the M-line crosses `n` times. Good among convex obstacles, where it beats [`Bug1`](super::Bug1); in a
    /// maze it can follow parts of a boundary again and again.
    ///
    /// # Model
    ///
    /// As for [`DistBug`](super::DistBug): the robot is a disc, and boundaries are those of obstacles grown by it. Of the
    /// lidar it uses no more than a robot that feels its surroundings would. It rolls on for some centimetres when it
    /// leaves, so that the M-line is drawn anew from each hit point to the goal; the times that a boundary is crossed are
    /// those of the line on which it was met.
    Bug2, "Bug2", FirstLeave<OnMainLine<false>>, PathBound::Crossings
}
