use super::algorithm::bug_algorithm;
use super::first_leave::FirstLeave;
use super::leave_rule::Nearer;

bug_algorithm! {
    /// Class1: leaves an obstacle as soon as the robot is nearer to the goal than ever before and can move
    /// towards it (H. Noborio, "A sufficient condition for designing a family of sensor-based deadlock-free
    /// path-planning algorithms", Advanced Robotics 7(5), 1993; at a conference in 1992).
    ///
    /// The robot drives towards the goal until an obstacle blocks it, follows the boundary, and records its
    /// smallest distance to the goal at blocked points. It leaves where the way is open and the distance
    /// smaller by STEP. All round without having left, it reports that no way exists.
    ///
    /// # Guarantee
    ///
    /// Complete: the distance of hit points to the goal decreases by at least STEP, and a boundary can always
    /// be left at its point nearest to a goal outside. No bound in terms of perimeters is known.
    Class1, "Class1", FirstLeave<Nearer<true>>, PathBound::Unknown
}
