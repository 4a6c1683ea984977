// This file compiles without the standard library.

use super::cause::{Causes, Requests};

/// State of the vehicle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum SafetyState {
    /// A person drives.
    #[default]
    Manual,
    /// The vehicle stands, ready for automatic driving.
    Armed,
    /// The program drives.
    Auto,
    /// The vehicle brakes gently and stands.
    SafeStop,
    /// The vehicle brakes as hard as it can, without power, and stands.
    EmergencyStop,
}

impl SafetyState {
    /// All states.
    pub const ALL: [Self; 5] = [Self::Manual, Self::Armed, Self::Auto, Self::SafeStop, Self::EmergencyStop];

    /// Severity: 0 without a stop, 1 for a safe stop, 2 for an emergency stop.
    pub const fn severity(self) -> u8 {
        match self {
            Self::Manual | Self::Armed | Self::Auto => 0,
            Self::SafeStop => 1,
            Self::EmergencyStop => 2,
        }
    }

    /// Whether this is one of the two stops.
    pub const fn is_stop(self) -> bool {
        self.severity() > 0
    }

    /// Whether a program's commands reach the wheels.
    pub const fn lets_drive(self) -> bool {
        matches!(self, Self::Auto)
    }
}

/// Inputs of the state machine in one control period.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct SafetyInputs {
    /// Active causes.
    pub causes: Causes,
    /// Requests of the operator.
    pub requests: Requests,
    /// Whether the vehicle stands.
    pub standing: bool,
}

/// The safety state machine. It is deterministic: equal inputs lead to equal states.
///
/// ```
/// use roverlab::safety::{Causes, Requests, SafetyCore, SafetyInputs, SafetyState};
/// let mut core = SafetyCore::new();
/// let standing = SafetyInputs { standing: true, ..SafetyInputs::default() };
/// core.step(standing);
/// core.step(SafetyInputs { requests: Requests { arm: true, ..Requests::default() }, ..standing });
/// let start = Requests { start: true, ..Requests::default() };
/// assert_eq!(core.step(SafetyInputs { requests: start, ..standing }), SafetyState::Auto);
/// // The worse cause wins.
/// let causes = Causes::HEARTBEAT_LOST.with(Causes::REMOTE_STOP);
/// assert_eq!(core.step(SafetyInputs { causes, ..SafetyInputs::default() }), SafetyState::EmergencyStop);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct SafetyCore {
    state: SafetyState,
    /// Requests in the last control period.
    last: Requests,
}

impl Default for SafetyCore {
    fn default() -> Self {
        Self::new()
    }
}

impl SafetyCore {
    /// Starts in `Manual`. A request that is active in the first period does not count: its button may be
    /// stuck.
    pub const fn new() -> Self {
        let last = Requests { arm: true, start: true, disarm: true };
        Self { state: SafetyState::Manual, last }
    }

    /// The present state.
    pub const fn state(&self) -> SafetyState {
        self.state
    }

    /// Advances by one control period and returns the new state.
    pub const fn step(&mut self, inputs: SafetyInputs) -> SafetyState {
        let SafetyInputs { causes, requests, standing } = inputs;
        let rises = Requests {
            arm: requests.arm && !self.last.arm,
            start: requests.start && !self.last.start,
            disarm: requests.disarm && !self.last.disarm,
        };
        self.last = requests;
        self.state = next(self.state, causes, rises, standing);
        self.state
    }
}

/// Transition table.
const fn next(state: SafetyState, causes: Causes, rises: Requests, standing: bool) -> SafetyState {
    use SafetyState::{Armed, Auto, EmergencyStop, Manual, SafeStop};
    if causes.is_hard() {
        return EmergencyStop;
    }
    let may_arm = rises.arm && !rises.disarm && standing && causes.is_empty();
    let to_person = causes.has(Causes::DRIVER) || rises.disarm;
    match state {
        Armed | Auto if causes.is_soft() => SafeStop,
        Armed | Auto if to_person => Manual,
        Armed if rises.start => Auto,
        // A soft cause does not take control from a driver, so `Manual` stays.
        Manual | SafeStop | EmergencyStop if may_arm => Armed,
        unchanged => unchanged,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Stream;

    /// Reference: the first rule that applies decides. Derived from the specification, not from the code.
    fn expected(state: SafetyState, inputs: SafetyInputs, rises: Requests) -> SafetyState {
        use SafetyState::*;
        type Rule = (bool, SafetyState);
        let SafetyInputs { causes, standing, .. } = inputs;
        let hard = causes.has(Causes::EMERGENCY_BUTTON) || causes.has(Causes::REMOTE_STOP);
        let soft = [
            Causes::HEARTBEAT_LOST,
            Causes::OUTSIDE_FENCE,
            Causes::WATCHDOG,
            Causes::SENSOR,
            Causes::CLOCK,
            Causes::LINK,
        ]
        .iter()
        .any(|&cause| causes.has(cause));
        let driver = causes.has(Causes::DRIVER);
        let by_itself = state == Armed || state == Auto;
        let arms = rises.arm && !rises.disarm && standing && !hard && !soft && !driver;
        let rules: [Rule; 6] = [
            (hard, EmergencyStop),
            (by_itself && soft, SafeStop),
            (by_itself && (driver || rises.disarm), Manual),
            (state == Armed && rises.start, Auto),
            (!by_itself && arms, Armed),
            (true, state),
        ];
        rules.iter().find(|(applies, _)| *applies).unwrap().1
    }

    fn random_inputs(random: &mut Stream) -> SafetyInputs {
        let bits = random.bits();
        // Causes are rare, so that every state is visited often.
        let causes = if bits.is_multiple_of(8) {
            Causes::from_bits((random.bits() & random.bits()) as u16)
        } else {
            Causes::NONE
        };
        let bit = |i: u32| bits >> i & 1 == 1;
        let requests = Requests { arm: bit(8), start: bit(9), disarm: bit(10) && bit(11) };
        SafetyInputs { causes, requests, standing: bit(12) || bit(13) }
    }

    /// Ten million random transitions, compared with the reference and with the invariants of the table.
    #[test]
    fn random_transitions_follow_the_reference() {
        let steps = 10_000_000;
        let (mut core, mut random) = (SafetyCore::new(), Stream::new(14));
        let mut last = Requests { arm: true, start: true, disarm: true };
        let mut visits = [[0_u32; 5]; 5];
        for _ in 0..steps {
            let (before, inputs) = (core.state(), random_inputs(&mut random));
            let rises = Requests {
                arm: inputs.requests.arm && !last.arm,
                start: inputs.requests.start && !last.start,
                disarm: inputs.requests.disarm && !last.disarm,
            };
            let after = core.step(inputs);
            assert_eq!(after, expected(before, inputs, rises), "{before:?} {inputs:?}");
            if after == SafetyState::Auto && before != SafetyState::Auto {
                assert_eq!(before, SafetyState::Armed, "automatic driving begins armed");
            }
            if before.is_stop() && !after.is_stop() {
                assert!(
                    rises.arm && inputs.standing && inputs.causes.is_empty(),
                    "only arming leaves a stop"
                );
            }
            if inputs.causes.is_hard() {
                assert_eq!(after, SafetyState::EmergencyStop);
            }
            assert!(after.severity() >= before.severity() || rises.arm, "severity never falls by itself");
            visits[before as usize][after as usize] += 1;
            last = inputs.requests;
        }
        let possible = visits.iter().flatten().filter(|&&count| count > 100).count();
        assert_eq!(possible, 17, "every transition of the table was taken: {visits:?}");
    }

    #[test]
    fn a_button_that_is_stuck_arms_nothing() {
        let mut core = SafetyCore::new();
        let arm = Requests { arm: true, ..Requests::default() };
        let held = SafetyInputs { requests: arm, standing: true, ..SafetyInputs::default() };
        assert_eq!(core.step(held), SafetyState::Manual, "stuck since before power-on");
        core.step(SafetyInputs { causes: Causes::REMOTE_STOP, ..held });
        for _ in 0..10 {
            assert_eq!(core.step(held), SafetyState::EmergencyStop);
        }
        core.step(SafetyInputs { requests: Requests::default(), ..held });
        let both = Requests { disarm: true, ..arm };
        assert_eq!(core.step(SafetyInputs { requests: both, ..held }), SafetyState::EmergencyStop);
        core.step(SafetyInputs { requests: Requests::default(), ..held });
        assert_eq!(core.step(held), SafetyState::Armed);
    }
}
