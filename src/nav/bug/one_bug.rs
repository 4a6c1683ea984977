use super::algorithm::bug_algorithm;
use super::first_leave::FirstLeave;
use super::leave_rule::Nearer;

bug_algorithm! {
    /// OneBug: leaves an obstacle as soon as the robot is nearer to the goal than at the hit point and can
    /// move towards it. It remembers only that distance.
    ///
    /// The name is from J. Ng and T. Bräunl, "Performance comparison of bug navigation algorithms", Journal
    /// of Intelligent and Robotic Systems 50, 2007. The definition is this library's own and makes no claim
    /// about theirs.
    ///
    /// # Guarantee
    ///
    /// Complete: every leave point is nearer to the goal than its hit point by at least STEP, and an obstacle
    /// without one, all round, proves that no way exists. Unlike [`Class1`](super::Class1) it may leave
    /// although it was nearer to the goal before.
    OneBug, "OneBug", FirstLeave<Nearer<false>>, PathBound::Unknown
}
