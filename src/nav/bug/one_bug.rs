use super::algorithm::bug_algorithm;
use super::first_leave::FirstLeave;
use super::leave_rule::Nearer;

bug_algorithm! {
    /// OneBug: leaves an obstacle as soon as the robot is nearer to the goal than at the hit point and can move towards it;
    /// this one distance is all that it remembers.
    ///
    /// The name is from J. Ng and T. Bräunl, "Performance comparison of bug navigation algorithms", Journal of Intelligent
    /// and Robotic Systems 50, 2007. The definition is this library's own, and no claim about theirs.
    ///
    /// # Guarantee
    ///
    /// Complete: every leave point is nearer to the goal than its hit point, by STEP at least, and all round an obstacle
    /// without one there is no way. Where [`Class1`](super::Class1) has once been nearer, it waits; this does not.
    OneBug, "OneBug", FirstLeave<Nearer<false>>, PathBound::Unknown
}
