use super::algorithm::bug_algorithm;
use super::hit_point_memory::HitPointMemory;
use super::leave_rule::Nearer;

bug_algorithm! {
    /// Rev2: [`Alg2`](super::Alg2) that follows obstacles on alternate sides (Y. Horiuchi and H. Noborio, "Evaluation of path length made
    /// in sensor-based path-planning with the alternative following", IEEE International Conference on Robotics and
    /// Automation, 2001).
    ///
    /// At every hit point it takes the other side than it followed last.
    ///
    /// # Guarantee
    ///
    /// Complete, as Alg2 is, for which either side is as good.
    Rev2, "Rev2", HitPointMemory<Nearer<true>, true>, PathBound::Unknown
}
