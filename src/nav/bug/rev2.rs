use super::algorithm::bug_algorithm;
use super::hit_point_memory::HitPointMemory;
use super::leave_rule::Nearer;

bug_algorithm! {
    /// Rev2: [`Alg2`](super::Alg2) on alternate sides (Y. Horiuchi and H. Noborio, "Evaluation of path length
    /// made in sensor-based path-planning with the alternative following", IEEE International Conference on
    /// Robotics and Automation, 2001).
    ///
    /// At every hit point it takes the other side than last time.
    ///
    /// # Guarantee
    ///
    /// Complete, like Alg2, for which either side is equally good.
    Rev2, "Rev2", HitPointMemory<Nearer<true>, true>, PathBound::Unknown
}
