use super::algorithm::bug_algorithm;
use super::hit_point_memory::HitPointMemory;
use super::leave_rule::Nearer;

bug_algorithm! {
    /// Alg2: the leave condition of [`Class1`](super::Class1), with a memory of hit and leave points (A.
    /// Sankaranarayanan and M. Vidyasagar, "Path planning for moving a point object amidst unknown obstacles
    /// in a plane: a new algorithm and a general theory for algorithm development", IEEE Conference on
    /// Decision and Control, 1990).
    ///
    /// The robot leaves an obstacle as soon as it can move towards the goal and is nearer to it than ever
    /// before. If it meets an earlier hit or leave point while following a boundary, it returns to the
    /// current hit point and follows the boundary the other way, once per hit point. Back at the hit point
    /// without having left, it reports that no way exists.
    ///
    /// # Guarantee
    ///
    /// Complete. See [`Alg1`](super::Alg1) for the model.
    Alg2, "Alg2", HitPointMemory<Nearer<true>, false>, PathBound::Unknown
}
