use super::algorithm::bug_algorithm;
use super::hit_point_memory::HitPointMemory;
use super::leave_rule::OnMainLine;

bug_algorithm! {
    /// Alg1: Bug2 with a memory of its hit and leave points (A. Sankaranarayanan and M. Vidyasagar, "A new
    /// path planning algorithm for moving a point object amidst unknown obstacles in a plane", IEEE
    /// International Conference on Robotics and Automation, 1990).
    ///
    /// The robot leaves an obstacle where it crosses the straight line from start to goal, nearer to the goal
    /// than ever before on that line, with the way along it open. If it meets an earlier hit or leave point
    /// while following a boundary, it returns to the current hit point and follows the boundary the other
    /// way, once per hit point. Back at the hit point without having left, it reports that no way exists.
    ///
    /// # Guarantee
    ///
    /// Complete. No part of a boundary is followed more than twice in the same direction;
    /// [`Bug2`](super::Bug2) may do so in a maze.
    ///
    /// # Model
    ///
    /// As for [`Bug2`](super::Bug2), including the M-line. A point counts as met again if both its position
    /// and the direction of the wall match, which distinguishes the two sides of a thin wall.
    Alg1, "Alg1", HitPointMemory<OnMainLine<true>, false>, PathBound::Unknown
}
