use super::algorithm::bug_algorithm;
use super::hit_point_memory::HitPointMemory;
use super::leave_rule::OnMainLine;

bug_algorithm! {
    /// Alg1: Bug2 with a memory of its hit and leave points (A. Sankaranarayanan and M. Vidyasagar, "A new path planning
    /// algorithm for moving a point object amidst unknown obstacles in a plane", IEEE International Conference on Robotics
    /// and Automation, 1990).
    ///
    /// The robot leaves an obstacle where it meets the straight line from start to goal, nearer to the goal than it has ever
    /// been on that line, with the way along it open. If it comes to a hit or leave point of before while it follows a
    /// boundary, it returns to the present hit point and follows the boundary the other way; once for each hit point. Back
    /// at the hit point without having left, it knows that there is no way.
    ///
    /// # Guarantee
    ///
    /// Complete, and no part of a boundary is followed for a third time in the same sense, as [`Bug2`](super::Bug2) may do
    /// in a maze.
    ///
    /// # Model
    ///
    /// As for [`Bug2`](super::Bug2), whose M-line it is. A point is met again where both the place and the direction of the
    /// wall are those of before, which tells the two sides of a thin wall apart.
    Alg1, "Alg1", HitPointMemory<OnMainLine<true>, false>, PathBound::Unknown
}
