use super::body::Body;
use super::leave_rule::LeaveRule;
use super::strategy::{Decision, Sight, Strategy};

/// Follows the boundary in one direction until a rule allows to leave.
#[derive(Debug, Clone, Default)]
pub(super) struct FirstLeave<R> {
    rule: R,
}

impl<R: LeaveRule> Strategy for FirstLeave<R> {
    fn meet(&mut self, meeting: &Sight) {
        self.rule.meet(meeting);
    }

    fn consider(&mut self, _body: &Body, sight: &Sight) -> Decision {
        let leave = self.rule.allows(sight);
        if leave { Decision::Leave } else { Decision::Follow }
    }
}
