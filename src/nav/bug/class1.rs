use super::algorithm::bug_algorithm;
use super::first_leave::FirstLeave;
use super::leave_rule::Nearer;

bug_algorithm! {
    /// Class1: leaves an obstacle as soon as the robot is nearer to the goal than ever before and can move towards it
    /// (H. Noborio, "A sufficient condition for designing a family of sensor-based deadlock-free path-planning algorithms",
    /// Advanced Robotics 7(5), 1993; at a conference in 1992).
    ///
    /// The robot drives at the goal until something is in the way, follows the boundary, and keeps how near to the goal it
    /// has been where the way was blocked. Where the way is open, nearer by STEP than that, it leaves. All round without
    /// having left, it knows that there is no way.
    ///
    /// # Guarantee
    ///
    /// Complete: hit points get nearer and nearer to the goal, by STEP at least, and the place of a boundary that is nearest
    /// to a goal outside of it can always be left. No bound in terms of perimeters.
    Class1, "Class1", FirstLeave<Nearer<true>>, PathBound::Unknown
}
