use super::body::Body;
use super::family::family;
use super::leave_rule::{LeaveRule, Nearer, OnMainLine};
use super::strategy::{Decision, Sight, Strategy};

family! {
    /// Bug2: leaves an obstacle on the straight line from start to goal (V. J. Lumelsky and A. A. Stepanov, "Path-planning
    /// strategies for a point mobile automaton moving amidst unknown obstacles of arbitrary shape", Algorithmica 2, 1987).
    ///
    /// The robot drives along that line, the *M-line*, until something is in the way: the hit point. It follows the
    /// boundary until it meets the M-line again, nearer to the goal than the hit point, with the way along it open: the
    /// leave point. Back at the hit point without having left, it knows that there is no way.
    ///
    /// # Guarantee
    ///
    /// Complete. The path is at most `D + sum(n p) / 2`, where `D` is the straight distance, and `p` the perimeter of a
    /// boundary that the M-line crosses `n` times. Good among convex obstacles, where it beats [`Bug1`](super::Bug1); in a
    /// maze it can follow parts of a boundary again and again.
    ///
    /// # Model
    ///
    /// As for [`DistBug`](super::DistBug): the robot is a disc, and boundaries are those of obstacles grown by it. Of the
    /// lidar it uses no more than a robot that feels its surroundings would. It rolls on for some centimetres when it
    /// leaves, so that the M-line is drawn anew from each hit point to the goal; the times that a boundary is crossed are
    /// those of the line on which it was met.
    Bug2, "Bug2", Plain<OnMainLine<false>>, PathBound::Crossings
}

family! {
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
    Class1, "Class1", Plain<Nearer<true>>, PathBound::Unknown
}

family! {
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
    OneBug, "OneBug", Plain<Nearer<false>>, PathBound::Unknown
}

/// Follows one way round until a rule allows to leave.
#[derive(Debug, Clone, Default)]
pub(super) struct Plain<R> {
    rule: R,
}

impl<R: LeaveRule> Strategy for Plain<R> {
    fn meet(&mut self, meeting: &Sight) {
        self.rule.meet(meeting);
    }

    fn consider(&mut self, body: &Body, sight: &Sight) -> Decision {
        let leave = self.rule.allows(body.goal, sight);
        if leave { Decision::Leave } else { Decision::Follow }
    }
}
