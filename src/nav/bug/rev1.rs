use super::algorithm::bug_algorithm;
use super::hit_point_memory::HitPointMemory;
use super::leave_rule::OnMainLine;

bug_algorithm! {
    /// Rev1: [`Alg1`](super::Alg1) that follows obstacles on alternate sides (Y. Horiuchi and H. Noborio, "Evaluation of path length made
    /// in sensor-based path-planning with the alternative following", IEEE International Conference on Robotics and
    /// Automation, 2001).
    ///
    /// At every hit point it takes the other side than it followed last, so that it does not run round a maze the same way
    /// for ever.
    ///
    /// # Guarantee
    ///
    /// Complete, as Alg1 is, for which either side is as good.
    Rev1, "Rev1", HitPointMemory<OnMainLine<true>, true>, PathBound::Unknown
}
