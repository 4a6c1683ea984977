use super::algorithm::bug_algorithm;
use super::hit_point_memory::HitPointMemory;
use super::leave_rule::OnMainLine;

bug_algorithm! {
    /// Rev1: [`Alg1`](super::Alg1) on alternate sides (Y. Horiuchi and H. Noborio, "Evaluation of path length
    /// made in sensor-based path-planning with the alternative following", IEEE International Conference on
    /// Robotics and Automation, 2001).
    ///
    /// At every hit point it takes the other side than last time, so that it does not keep running round a
    /// maze the same way.
    ///
    /// # Guarantee
    ///
    /// Complete, like Alg1, for which either side is equally good.
    Rev1, "Rev1", HitPointMemory<OnMainLine<true>, true>, PathBound::Unknown
}
